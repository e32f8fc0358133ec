"""Run one case of a file, or a command, in this process."""

from pathlib import Path

from harness.cli.main import main
from harness.session import run_case as session
from harness.session.run_request import RunRequest


def run_case(file, **options):
    return session.run_case(RunRequest(Path(file), **options))


def exit_code(*words):
    """The exit code of a command, also where its arguments are wrong."""
    try:
        return main([str(word) for word in words])
    except SystemExit as end:  # of argparse
        return end.code
