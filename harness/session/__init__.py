"""One scenario: the only place that joins engine, adapters, assertions and reports."""

from harness.reporting.result import CaseResult, ProgressEvent, StepLine
from harness.session.check import CheckResult, check_file, explain_file
from harness.session.rejudge import judge_run
from harness.session.run_case import run_case

__all__ = [
    "CaseResult",
    "CheckResult",
    "ProgressEvent",
    "StepLine",
    "check_file",
    "explain_file",
    "judge_run",
    "run_case",
]
