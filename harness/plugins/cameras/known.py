"""Whether a camera that a file names exists."""

from __future__ import annotations

from harness.cell.scope import Scope
from harness.language.files.source import Loc


def check_camera(name: str, scope: Scope, loc: Loc) -> None:
    """Report a name that is no camera of the robot, the world or the scenario."""
    if name not in scope.cameras:
        scope.problems.unknown(loc, "camera", name, scope.cameras)
