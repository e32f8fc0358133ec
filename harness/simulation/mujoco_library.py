"""MuJoCo, imported without its window library, which starts a process to find out its version."""

from __future__ import annotations

from harness.core.deferred_import import deferred

with deferred("glfw"):
    import mujoco as mujoco
