"""A correct solver, and ways to break it."""

from functools import lru_cache

from docs import ROOT
from harness.plugins.iktest.builtin_ik import own_solver
from harness.plugins.iktest.worker import find_function
from harness.robot.robot_source import RobotSource

EXAMPLES = ROOT / "scenarios/ik_test"
OM = "open_manipulator_x"

correct = find_function(f"{EXAMPLES / 'corrected_ik.py'}:ik")


@lru_cache(maxsize=1)
def _ur3e():
    return own_solver(RobotSource("ur3e"))


def ur3e(matrix):
    """All joint positions of a UR3e for a pose."""
    return _ur3e()(matrix=matrix, seed=[0.0] * 6)
