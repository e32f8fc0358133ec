"""A run imports the libraries that it uses, and no others."""

import subprocess
import sys

NEVER_USED = ("matplotlib", "scipy", "glfw", "OpenGL", "numba", "PIL", "rosbags", "pandas")


def test_a_run_imports_no_library_that_it_does_not_use():
    code = (
        "import sys; from harness.suite.server import preload; from harness.suite.warm import *\n"
        f"preload(RUN_MODULES); print(*[name for name in {NEVER_USED} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []
