"""Location of the bundled files, in the checkout or inside the installed package."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

PACKAGE = Path(__file__).resolve().parent.parent


def data_folder(kind: Literal["robots", "worlds", "scenarios"]) -> Path:
    """The folder of the bundled robots, worlds or scenarios."""
    installed = PACKAGE / "data" / kind
    return installed if installed.is_dir() else PACKAGE.parent / kind
