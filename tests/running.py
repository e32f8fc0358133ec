"""Run one case of a file in this process."""

from pathlib import Path

from harness.session import run_case as session
from harness.session.run_request import RunRequest


def run_case(file, **options):
    return session.run_case(RunRequest(Path(file), **options))
