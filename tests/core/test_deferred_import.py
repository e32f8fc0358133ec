"""Libraries are imported without the modules that only unused functions need."""

import subprocess
import sys

BEGIN = "import sys; from harness.core.deferred_import import deferred\n"


def run(code):
    done = subprocess.run(
        [sys.executable, "-c", BEGIN + code], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def test_a_deferred_module_is_imported_when_it_is_first_used(tmp_path):
    library = tmp_path / "library.py"
    library.write_text(
        "import json.tool as tool\nfrom fractions import Fraction\n"
        "def half(): return Fraction(1, 2)\ndef name(): return tool.__name__\n"
    )
    shown = run(
        f"sys.path.insert(0, {str(tmp_path)!r})\n"
        "with deferred('json', 'json.tool', 'fractions'): import library\n"
        "print('fractions' in sys.modules, 'json' in sys.modules)\n"
        "print(library.half(), 'fractions' in sys.modules)\n"
        "print(callable(library.tool.main), 'json.tool' in sys.modules)\n"
    )
    assert shown == ["False", "False", "1/2", "True", "True", "True"]


def test_a_module_that_is_there_already_is_used():
    code = "import fractions\nwith deferred('fractions'): import fractions as f\n"
    assert run(f"{code}print(f is fractions)") == ["True"]


def test_the_physics_is_imported_without_windows():
    shown = run(
        "from harness.simulation.mujoco_library import mujoco\n"
        "print('glfw' in sys.modules, mujoco.MjModel.from_xml_string('<mujoco/>').nbody)"
    )
    assert shown == ["False", "1"]
