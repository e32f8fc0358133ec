"""`harness new`: a scenario to start from."""

from __future__ import annotations

import argparse
import shlex
from pathlib import Path

from harness.cli.output import guarded, say
from harness.suite.discovery import SUFFIX, UsageError

TEMPLATE = Path(__file__).parent / "templates" / "new.scenario.yaml"


def run(arguments: argparse.Namespace) -> int:
    """Write the template to a file that is not there yet."""
    return guarded(lambda: _run(Path(arguments.file)))


def _run(file: Path) -> int:
    if not file.name.endswith(SUFFIX):
        stem = file.name.removesuffix(".yaml").removesuffix(".yml")
        better = file.with_name(f"{stem}{SUFFIX}")
        raise UsageError(f"the name of a scenario ends in {SUFFIX}: try '{better}'")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("x", encoding="utf-8") as new:
            new.write(TEMPLATE.read_text(encoding="utf-8"))
    except FileExistsError:
        raise UsageError(f"'{file}' is there already; nothing was written") from None
    except OSError as error:
        raise UsageError(f"cannot write '{file}': {error.strerror}") from error
    name = shlex.quote(str(file))
    say(f"wrote {file}\ncheck it: harness check {name}\nrun it:   harness run {name}")
    return 0
