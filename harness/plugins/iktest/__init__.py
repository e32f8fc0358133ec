"""Property-based tests of any function that solves inverse kinematics.

`check_ik` is for tests, `run_ik_test` for programs, `harness ik-test` for the command line.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from harness.plugins.iktest.kit import IkTest, check_ik, run_ik_test
    from harness.plugins.iktest.report import IkFinding, IkReport, PropertyResult

EXTRAS = {"hypothesis": "ik-test"}
"""Packages that it needs, and the extra that has each."""
__all__ = ["IkFinding", "IkReport", "IkTest", "PropertyResult", "check_ik", "run_ik_test"]


def __getattr__(name: str) -> Any:
    """Import what is named when it is used: the test kit needs planners and Hypothesis."""
    from importlib import import_module

    modules = {"kit": ("IkTest", "check_ik", "run_ik_test")}
    modules["report"] = ("IkFinding", "IkReport", "PropertyResult")
    for module, names in modules.items():
        if name in names:
            return getattr(import_module(f"{__name__}.{module}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
