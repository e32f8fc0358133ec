"""`harness schema`."""

from __future__ import annotations

import argparse
from pathlib import Path

from harness.cli.output import guarded, output, say
from harness.suite.discovery import UsageError


def run(arguments: argparse.Namespace) -> int:
    """Print the JSON Schema of scenario files, or write it."""
    return guarded(lambda: _run(arguments.write))


def _run(file: str | None) -> int:
    from harness.language.schema import schema_text

    if file is None:
        output().document(schema_text())
        return 0
    try:
        Path(file).write_text(schema_text(), encoding="utf-8")
    except OSError as error:
        raise UsageError(f"cannot write '{file}': {error.strerror}") from error
    say(f"wrote {file}; the first line of a scenario can name it:")
    say(f"# yaml-language-server: $schema={file}")
    return 0
