"""How long a bag takes to be written, against the simulated time that it holds."""

import statistics
import time
import tracemalloc

import pytest

from harness.plugins.ros.bag.write import BagOptions, write_bag
from harness.recording.read_run import read_run
from tests.running import run_case

GOAL = 20
REPETITIONS = 3
MINUTE = """\
scenario: A minute at 100 Hz with a camera at 10 Hz
robot: {model: ur3e, gripper: rh_p12_rn_a, base: {xyz: [0, 0, 1.02]}}
world: lesson_ur
cameras:
  - name: over_view
    pose: {xyz: [1.3, 0.4, 1.7]}
    look_at: [0.3, 0, 1.1]
    image: {width: 160, height: 120}
    update_rate: 10
videos: [over_view]
steps:
  - repeat:
      times: 6
      steps:
        - move_to: mogi_home
        - ptp: {joints: {shoulder_pan_joint: -0.6}}
  - wait: 30 s
"""


@pytest.mark.benchmark
def test_a_minute_is_written_in_less_than_three_seconds(print_row, tmp_path):
    file = tmp_path / "minute.scenario.yaml"
    file.write_text(MINUTE)
    result = run_case(file, report_dir=tmp_path / "run", stills=False, page=False)
    assert result.outcome == "passed", result.message
    stored = read_run(tmp_path / "run")
    heading = f"bag of {result.sim_time:.0f} simulated s, medians of {REPETITIONS}"
    print_row(
        heading, "storage", "processor time", "x real time", "goal", "on disk", "peak of Python"
    )
    for storage in ("mcap", "sqlite3"):
        seconds = []
        for number in range(REPETITIONS + 1):
            place = tmp_path / f"{storage}{number}"
            begin = time.process_time()
            write_bag(place, stored, BagOptions(storage=storage))
            seconds.append(time.process_time() - begin)
        tracemalloc.start()
        write_bag(tmp_path / f"{storage}_traced", stored, BagOptions(storage=storage))
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        took = statistics.median(seconds[1:])
        size = sum(each.stat().st_size for each in place.iterdir())
        print_row(
            heading,
            storage,
            f"{took:.2f} s",
            f"{result.sim_time / took:.0f}x",
            f"{GOAL}x",
            f"{size / 1e6:.1f} MB",
            f"{peak / 1e6:.0f} MB",
        )
