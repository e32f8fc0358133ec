"""What an installation says on platforms for which required packages have no wheels."""

import os
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
refusal = runpy.run_path(str(ROOT / ".ci/platforms.py"))["refusal"]


@pytest.mark.parametrize(
    ("system", "machine", "c_library", "advice"),
    [
        ("win32", "AMD64", "", "wsl --install"),
        ("darwin", "x86_64", "", "development container"),
        ("linux", "x86_64", "", "python:3.12-slim"),
        ("linux", "riscv64", "glibc", "Linux on x86_64 or aarch64"),
    ],
)
def test_platforms_without_wheels_are_refused_with_what_to_do(system, machine, c_library, advice):
    assert advice in refusal(system, machine, c_library)


@pytest.mark.parametrize(
    ("system", "machine", "c_library"),
    [("linux", "x86_64", "glibc"), ("linux", "aarch64", "glibc"), ("darwin", "arm64", "")],
)
def test_platforms_with_wheels_are_not_refused(system, machine, c_library):
    assert not refusal(system, machine, c_library)


@pytest.mark.parametrize("anyway", ["", "1"])
def test_an_installation_ends_with_the_advice_alone(anyway, tmp_path):
    """The build backend, as pip starts it, on a machine that says that it is another one."""
    (tmp_path / "sitecustomize.py").write_text(
        "import platform\nplatform.machine = lambda: 'riscv64'\n"
    )
    code = "from hatchling.build import prepare_metadata_for_build_wheel as prepare; prepare('out')"
    (tmp_path / "out").mkdir()
    done = subprocess.run(
        [sys.executable, "-c", code.replace("'out'", repr(str(tmp_path / "out")))],
        cwd=ROOT, capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONPATH": str(tmp_path), "ARMHARNESS_ANY_PLATFORM": anyway},
    )  # fmt: skip
    assert (done.returncode == 0) == bool(anyway)
    assert ("have no wheels" in done.stderr) == (not anyway)
    assert "Traceback" not in done.stderr
