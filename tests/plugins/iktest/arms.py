"""A correct solver, and ways to break it."""

from docs import ROOT
from harness.plugins.iktest.worker import find_function

EXAMPLES = ROOT / "scenarios/ik_test"
OM = "open_manipulator_x"

correct = find_function(f"{EXAMPLES / 'corrected_ik.py'}:ik")
