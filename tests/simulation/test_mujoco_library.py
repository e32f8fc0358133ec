"""MuJoCo is imported without windows, which other programs may still open."""

import subprocess
import sys


def test_the_physics_is_imported_without_windows():
    code = (
        "import sys; from harness.simulation.mujoco_library import mujoco\n"
        "print('glfw' in sys.modules, mujoco.MjModel.from_xml_string('<mujoco/>').nbody)\n"
        "import glfw; print('glfw' in sys.modules)"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.split() == ["False", "1", "True"]
