"""Property-based tests of any function that solves inverse kinematics.

`check_ik` is for tests, `run_ik_test` for programs, `harness ik-test` for the command line.
"""

from harness.iktest.kit import IkTest, check_ik, run_ik_test
from harness.iktest.report import IkFinding, IkReport, PropertyResult

__all__ = ["IkFinding", "IkReport", "IkTest", "PropertyResult", "check_ik", "run_ik_test"]
