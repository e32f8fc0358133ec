"""How to install packages that not everyone needs."""

from __future__ import annotations

import shlex
import sys
from importlib.metadata import PackageNotFoundError, requires
from pathlib import Path

DISTRIBUTION = "armharness"


def install_command(extra: str) -> str:
    """A command for the packages of an extra that works in every folder.

    It names the packages themselves: a clone's distribution is on no index.
    """
    try:
        stated = requires(DISTRIBUTION) or []
    except PackageNotFoundError:  # a source tree that was never installed
        return _pip_install("-e", f"{Path(__file__).parents[2]}[{extra}]")
    marked = (requirement.partition(";") for requirement in stated)
    return _pip_install(
        *(
            name.strip()
            for name, _, marker in marked
            if marker.replace("'", '"').strip() == f'extra == "{extra}"'
        )
    )


def _pip_install(*what: str) -> str:
    return shlex.join([sys.executable, "-m", "pip", "install", *what])
