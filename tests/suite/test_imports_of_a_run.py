"""A run imports the libraries that it uses, and no others."""

import subprocess
import sys

import pytest

NEVER_USED = ("matplotlib", "scipy", "glfw", "OpenGL", "cv2", "rosbags", "pandas")
USED_BY_REPORTS = ("PIL", "jinja2", "numpy.ma")


@pytest.mark.nightly(but=["RUN_MODULES-unused0"])
@pytest.mark.parametrize(
    ("modules", "unused"),
    [
        ("RUN_MODULES", (*NEVER_USED, *USED_BY_REPORTS)),
        ("(*RUN_MODULES, *REPORT_MODULES)", NEVER_USED),
    ],
)
def test_a_run_imports_no_library_that_it_does_not_use(modules, unused):
    code = (
        "import sys; from harness.suite.server import preload; from harness.suite.warm import *\n"
        f"preload({modules}); print(*[name for name in {unused} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


def test_options_of_a_run_are_read_before_its_libraries_are_imported():
    """Then the process that runs cases starts to import them."""
    code = (
        "import sys; from harness.cli.main import parser_of\n"
        "words = ['run', 'x', '--baseline', 'y']; parser_of(words).parse_args(words)\n"
        "print(*[name for name in ('numpy', 'pydantic', 'yaml') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []
