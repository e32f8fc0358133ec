"""The required packages resolve on every platform, and with the libraries that users also have.

pip reads the metadata of packages from its index; nothing is installed.
"""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
ARM_LINUX = ("manylinux_2_28_aarch64", "manylinux_2_17_aarch64", "manylinux2014_aarch64")
PLATFORMS = {"macOS on Apple silicon": ("macosx_15_0_arm64",), "Linux on ARM": ARM_LINUX}

pytestmark = pytest.mark.nightly


def resolved(*arguments):
    """Versions that pip would install, by name."""
    command = [sys.executable, "-m", "pip", "install", "--dry-run", "--ignore-installed"]
    options = ["--quiet", "--report", "-", *arguments]
    done = subprocess.run([*command, *options], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)["install"]
    return {each["metadata"]["name"].lower(): each["metadata"]["version"] for each in found}


@pytest.mark.parametrize("python", ["3.11", "3.12", "3.13"])
@pytest.mark.parametrize("platform", PLATFORMS)
def test_every_required_package_has_a_wheel(platform, python, tmp_path):
    tags = [word for tag in PLATFORMS[platform] for word in ("--platform", tag)]
    options = ["--only-binary=:all:", "--python-version", python, "--target", str(tmp_path)]
    found = resolved(*options, *tags, *PROJECT["dependencies"])
    assert {"mujoco", "ompl", "pin"} <= set(found)


@pytest.mark.parametrize("library", ["lerobot", "vla-eval", "gymnasium", "robosuite"])
def test_another_library_can_be_installed_too(library):
    found = resolved(*PROJECT["dependencies"], library)
    assert {"mujoco", "ompl", "pin", library} <= set(found)


def test_the_newest_opencv_that_lerobot_accepts_is_accepted():
    found = resolved(*PROJECT["dependencies"], "opencv-python-headless<4.14")
    assert found["opencv-python-headless"].startswith("4.13.")
