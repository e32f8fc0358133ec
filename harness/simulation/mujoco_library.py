"""MuJoCo, imported without its window library, which starts a process to find out its version."""

from __future__ import annotations

import sys
from typing import Any, cast

modules = cast("dict[str, Any]", sys.modules)
is_hidden = modules.setdefault("glfw", None) is None  # a module that is None cannot be imported
try:
    import mujoco as mujoco
finally:
    if is_hidden:
        del modules["glfw"]
