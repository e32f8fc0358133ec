"""Location of the bundled files, in the checkout or inside the installed package."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import Literal

from harness.core.files import path_exists

PACKAGE = Path(__file__).resolve().parent.parent
SCENARIOS = "scenarios"


def data_folder(kind: Literal["robots", "worlds", "scenarios"]) -> Path:
    """The folder of the bundled robots, worlds or scenarios."""
    installed = PACKAGE / "data" / kind
    return installed if installed.is_dir() else PACKAGE.parent / kind


def existing_or_bundled(path: Path) -> Path:
    """The path, or the file or folder of the bundled scenarios with that name where it is nothing.

    Names begin below `scenarios`, or with it: `ik_test/student_ik.py`, `scenarios/lessons`.
    """
    if path_exists(path) or path.is_absolute() or ".." in path.parts:
        return path
    folder = data_folder(SCENARIOS)
    bundled = folder / path.relative_to(SCENARIOS if path.parts[:1] == (SCENARIOS,) else ".")
    return bundled if path_exists(bundled) else path


def with_short_names(text: str) -> str:
    """The text with paths of bundled scenarios as names that commands find in this folder."""
    if _scenarios_path() not in text:
        return text

    def short(path: re.Match[str]) -> str:
        return path[0] if path_exists(Path(path[1])) else path[1]

    return re.sub(re.escape(_scenarios_path()) + r"([\w./-]+)", short, text)


@cache
def _scenarios_path() -> str:
    return f"{data_folder(SCENARIOS)}/"
