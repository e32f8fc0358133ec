"""`harness explain`."""

from __future__ import annotations

import argparse

from harness.cli.output import guarded, say_text
from harness.suite.discovery import discover


def run(arguments: argparse.Namespace) -> int:
    """Print the program of each file."""
    return guarded(lambda: _run(arguments))


def _run(arguments: argparse.Namespace) -> int:
    files = discover(arguments.paths)
    from harness.session.check import explain_file

    for file in files:
        overrides = dict(arguments.overrides)
        say_text(explain_file(file, overrides=overrides, seed=arguments.seed).rstrip())
    return 0
