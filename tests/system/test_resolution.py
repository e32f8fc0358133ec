"""The required packages resolve on every platform, and with the libraries that users also have.

uv reads the metadata of packages from the index; nothing is installed.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("uv", reason="the resolver is in the extra `test`")

PROJECT = Path(__file__).parents[2] / "pyproject.toml"
EXTRAS = ("cameras", "meshes", "bags", "video", "search", "ik-test", "studio", "mcp", "parquet")
ALL = [f"--extra={extra}" for extra in EXTRAS]
PLATFORMS = {"Apple silicon": "aarch64-apple-darwin", "Linux on ARM": "aarch64-manylinux_2_28"}

pytestmark = [
    pytest.mark.nightly,
    pytest.mark.parametrize("python", ["3.11", "3.12", "3.13"]),
]


def resolved(python, *options, constraint=""):
    """Versions that would be installed, by name."""
    command = [sys.executable, "-m", "uv", "pip", "compile", "--quiet", "--no-annotate"]
    arguments = ["--python-version", python, *options, str(PROJECT), "-"]
    environment = {**os.environ, "MACOSX_DEPLOYMENT_TARGET": "15.0"}
    done = subprocess.run(
        [*command, *arguments],
        input=constraint, capture_output=True, text=True, check=False, env=environment,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    lines = [line for line in done.stdout.splitlines() if "==" in line]
    return dict(line.split(" ")[0].split("==") for line in lines)


@pytest.mark.parametrize("extras", [[], ALL], ids=["required", "extras"])
@pytest.mark.parametrize("platform", PLATFORMS)
def test_every_package_has_a_wheel(platform, extras, python):
    target = ["--python-platform", PLATFORMS[platform]]
    found = resolved(python, "--only-binary", ":all:", *target, *extras)
    assert {"mujoco", "ompl", "pin"} <= set(found)
    assert ("opencv-python-headless" in found) == bool(extras)


@pytest.mark.parametrize("platform", [*PLATFORMS, "Linux"])
@pytest.mark.parametrize("library", ["lerobot", "vla-eval", "gymnasium", "robosuite"])
def test_another_library_can_be_installed_too(library, platform, python):
    """With `-s`, the rows of the table in docs/guides/platforms.md."""
    target = ["--python-platform", PLATFORMS.get(platform, "x86_64-manylinux_2_28")]
    found = resolved(python, *target, *ALL, constraint=library)
    assert {"mujoco", "ompl", "pin", library} <= set(found)
    names = (library, "opencv-python-headless", "numpy")
    versions = " | ".join(found[name] for name in names)
    sys.stdout.write(f"\n| {library} | {python} | {platform} | {versions} |\n")


def test_the_newest_opencv_that_lerobot_accepts_is_accepted(python):
    found = resolved(python, *ALL, constraint="opencv-python-headless<4.14")
    assert found["opencv-python-headless"].startswith("4.13.")
