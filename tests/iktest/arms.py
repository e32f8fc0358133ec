"""A correct solver, and ways to break it."""

from harness.iktest.find_function import find_function
from tests.docs.generated import ROOT

EXAMPLES = ROOT / "scenarios/ik_test"
OM = "open_manipulator_x"

correct = find_function(f"{EXAMPLES / 'corrected_ik.py'}:ik")
