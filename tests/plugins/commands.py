"""The command line in processes of its own, with a folder of packages on Python's path."""

import os
import subprocess
import sys
from pathlib import Path

from tests import commands

EXAMPLE = Path(__file__).with_name("example_package")
MODULES = EXAMPLE / "example_arm_plugins"


def harness(folder, *arguments, site=None, code=0):
    """What a command prints, run in a folder; its cases have processes of their own with `site`."""
    if site is None:
        isolation = ["--in-process"] if arguments[0] == "run" else []
        done = commands.harness(*arguments, *isolation, cwd=folder)
    else:
        done = subprocess.run(
            [sys.executable, "-m", "harness.cli", *map(str, arguments)],
            cwd=folder,
            env={**os.environ, "PYTHONPATH": os.pathsep.join([str(site), *sys.path])},
            capture_output=True,
            text=True,
            check=False,
        )
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout + done.stderr
