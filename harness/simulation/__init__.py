"""Physics on MuJoCo."""

import harness.simulation.mujoco_library  # noqa: F401 - before any module imports MuJoCo itself
