"""How long the command line takes to answer, against an interpreter that does nothing."""

import subprocess
import sys

import pytest

from harness.core.resources import data_folder
from tests.benchmarks.interleaved import median_seconds, with_bytecode

FLAGSHIP = data_folder("scenarios") / "lessons/03_ur_sixteen_steps.scenario.yaml"
GOALS = {"harness --help": 5, "harness check": 15}
REPETITIONS = 9


def command(environment, *arguments):
    return lambda: subprocess.run(
        [sys.executable, *arguments], check=True, capture_output=True, env=environment
    )


@pytest.mark.benchmark
def test_start_up_of_help_and_check_against_a_bare_interpreter(print_row, tmp_path):
    environment = with_bytecode(tmp_path)
    seconds = median_seconds(
        {
            "python -c pass": command(environment, "-c", "pass"),
            "harness --help": command(environment, "-m", "harness.cli", "--help"),
            "harness check": command(environment, "-m", "harness.cli", "check", str(FLAGSHIP)),
        },
        REPETITIONS,
    )
    bare = seconds["python -c pass"]
    heading = f"start-up, medians of {REPETITIONS}"
    print_row(heading, "command", "wall", "x bare", "goal")
    for name, wall in seconds.items():
        goal = f"{GOALS[name]}x" if name in GOALS else ""
        print_row(heading, name, f"{1000 * wall:.0f} ms", f"{wall / bare:.1f}x", goal)
