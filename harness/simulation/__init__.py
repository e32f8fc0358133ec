"""Physics on MuJoCo: the model of robot and world, servos, gripper, faults and the recording."""

import harness.simulation.mujoco_library  # noqa: F401 - before any module imports MuJoCo itself
