"""Planners are compared on a scenario's own motions, the same every time but for the times."""

import json
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from harness.cli.main import main
from harness.core.trajectory import path_length
from harness.plugins.campaigns.bench.collect import collect
from harness.plugins.campaigns.bench.results import document
from harness.plugins.campaigns.bench.trial import even, smoothness
from harness.recording.read_run import read_run
from tests.running import run_case

PLANNERS = ["RRTConnect", "BKPIECE"]
SCENARIO = """\
scenario: Past two plates
robot: {model: ur3e, gripper: rh_p12_rn_a, base: {xyz: [0, 0, 1.02]}}
world: empty
steps:
  - move_to: mogi_down
    id: nothing_in_the_way
  - add_object:
      - name: plate
        box: {size: [0.05, 0.3, 0.2]}
        pose: {frame: base_link, xyz: [0, -0.6, 0.5]}
        in: planning
      - name: other_plate
        box: {size: [0.05, 0.3, 0.2]}
        pose: {frame: base_link, xyz: [0.3, 0.3, 0.7]}
        in: planning
  - move_to: up
    id: past_the_plates
"""


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("bench") / "plate.scenario.yaml"
    path.write_text(SCENARIO, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def motions(file):
    return collect(file, PLANNERS, [1, 2, 3], lambda _: None)


@pytest.mark.nightly
def test_every_planner_tries_every_searched_motion_from_every_seed(motions):
    assert [motion.is_searched for motion in motions] == [False, True]
    searched = [motion for motion in motions if motion.is_searched]
    for motion in searched:
        assert [(t.planner, t.seed) for t in motion.trials] == [
            (planner, seed) for planner in PLANNERS for seed in (1, 2, 3)
        ]
        for trial in motion.trials:
            assert trial.state_checks > 0
            assert trial.is_solved
            assert trial.planning_time > 0
            assert trial.path_length > 0.5
            assert trial.clearance <= trial.mean_clearance
            assert trial.clearance > 0


@pytest.mark.nightly
def test_the_numbers_are_the_same_every_time_but_for_the_times(file, motions):
    again = document(collect(file, PLANNERS, [1, 2, 3], lambda _: None), PLANNERS, [1, 2, 3])
    once = document(motions, PLANNERS, [1, 2, 3])
    times = once.pop("wall_times")
    assert again.pop("wall_times") != times
    assert json.dumps(again) == json.dumps(once)


@pytest.mark.nightly
def test_a_trial_is_the_plan_of_a_run_with_the_same_seed(file, motions, tmp_path):
    result = run_case(
        file,
        seed=2,
        overrides={"planning.planner_id": "BKPIECE"},
        report_dir=tmp_path / "run",
        stills=False,
    )
    assert result.outcome == "passed"
    steps = {step.id: step for step in read_run(tmp_path / "run").run.steps}
    [motion] = [motion for motion in motions if motion.step == "past_the_plates"]
    [trial] = [t for t in motion.trials if (t.planner, t.seed) == ("BKPIECE", 2)]
    positions = steps["past_the_plates"].trajectory.positions
    assert path_length(np.asarray(positions)) == pytest.approx(trial.path_length, rel=1e-6)


def test_one_command_prints_plots_and_keeps_the_numbers(file, tmp_path, capsys):
    code = main(
        ["bench", str(file), "--planners=RRTConnect", "--seeds=2", f"--report-dir={tmp_path}"]
    )
    assert code == 0
    said = capsys.readouterr().out
    assert "motions are searched, 2 seeds; medians:" in said
    assert "1 of 2 motions" in said
    folder = tmp_path / "bench"
    kept = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    assert kept["format"] == "armharness-bench/1"
    assert len(kept["wall_times"]) == len(kept["motions"])
    picture = ET.parse(folder / "benchmark.svg").getroot()
    texts = [item.text for item in picture.iter("{http://www.w3.org/2000/svg}text")]
    for name in ("success [%]", "state checks", "smoothness [rad²]", "clearance [mm]"):
        assert name in texts


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--planners", "RRTConect"], "did you mean `RRTConnect`?"),
        (["--planners", "CHOMP"], "planner 'CHOMP' is refused"),
        (["--planners", "SBL"], "planner 'SBL' is refused"),
    ],
)
def test_a_planner_that_is_not_there_is_reported_before_anything_is_planned(
    file, arguments, said, capsys
):
    assert main(["bench", str(file), *arguments]) == 2
    assert said in capsys.readouterr().err


def test_a_file_with_mistakes_is_reported_with_its_line(tmp_path, capsys):
    path = tmp_path / "wrong.scenario.yaml"
    path.write_text(SCENARIO.replace("move_to: mogi_down", "move_to: mogi_don"), encoding="utf-8")
    assert main(["bench", str(path), "--planners", "RRTConnect"]) == 2
    assert "wrong.scenario.yaml:5:14" in capsys.readouterr().err


def test_smoothness_is_nothing_when_straight_and_grows_with_a_corner():
    straight = even(np.array([[0.0, 0.0], [1.0, 1.0]]))
    bent = even(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]))
    assert smoothness(straight) == 0.0
    assert smoothness(bent) == pytest.approx((2 * np.pi / 2) ** 2 / (len(bent) - 2), rel=0.01)
    assert path_length(bent) == pytest.approx(2.0, abs=0.05)
