"""How long the command line takes to answer, against an interpreter that does nothing."""

import subprocess
import sys

import pytest

from harness.core.resources import data_folder
from tests.benchmarks.interleaved import median_seconds

FLAGSHIP = data_folder("scenarios") / "lessons/03_ur_sixteen_steps.scenario.yaml"
GOALS = {"harness --help": 5, "harness check": 15}
REPETITIONS = 9


def command(*arguments):
    return lambda: subprocess.run([sys.executable, *arguments], check=True, capture_output=True)


@pytest.mark.benchmark
def test_start_up_of_help_and_check_against_a_bare_interpreter(print_row):
    seconds = median_seconds(
        {
            "python -c pass": command("-c", "pass"),
            "harness --help": command("-m", "harness.cli", "--help"),
            "harness check": command("-m", "harness.cli", "check", str(FLAGSHIP)),
        },
        REPETITIONS,
    )
    bare = seconds["python -c pass"]
    heading = f"start-up, medians of {REPETITIONS}"
    print_row(heading, "command", "wall", "x bare", "goal")
    for name, wall in seconds.items():
        goal = f"{GOALS[name]}x" if name in GOALS else ""
        print_row(heading, name, f"{1000 * wall:.0f} ms", f"{wall / bare:.1f}x", goal)
