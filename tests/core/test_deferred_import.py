"""Libraries are imported without the modules that only unused functions need."""

import subprocess
import sys

import pytest

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


@pytest.mark.parametrize(
    ("library", "left_out", "still_works"),
    [
        (
            "from harness.planning.timing.toppra_library import toppra",
            ("matplotlib", "scipy"),
            "toppra.SplineInterpolator([0, 1, 2], [[0], [1], [0]])(1)[0]",
        ),
        (
            "from harness.simulation.mujoco_library import mujoco",
            ("glfw",),
            "float(mujoco.MjModel.from_xml_string('<mujoco/>').nbody)",
        ),
    ],
)
def test_solvers_are_imported_without_pictures_and_windows(library, left_out, still_works):
    shown = run(f"{library}\nprint(*[m for m in {left_out} if m in sys.modules], {still_works})")
    assert shown == ["1.0"]
