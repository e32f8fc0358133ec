"""A native library that crashes on a file costs an error that names the file, in any command."""

import os
import signal
import subprocess
import sys

import pytest

from tests.waiting import HANG, wait_for

SCENARIO = """\
scenario: an object of a mesh
robot: open_manipulator_x
objects:
  - {name: thing, mesh: {file: thing.stl}, static: true, pose: {xyz: [0.4, 0.4, 0.1]}}
steps: [{wait: 10 ms}]
"""
PLUGIN = """
import os, signal
from pathlib import Path
from harness.robot import mesh_file

read = mesh_file.read_triangles

def crashing(geometry):
    mesh_file.read_input(geometry.path)
    HOW

mesh_file.read_triangles = mesh_file.convex_hull = mesh_file.decomposition_of = crashing
"""
WAIT = "Path('waits').touch(); signal.pause()"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "a.scenario.yaml").write_text(SCENARIO)
    (tmp_path / "thing.stl").write_bytes(bytes(84))
    return tmp_path


def command(folder, how, *words):
    """A command whose reader of meshes ends otherwise."""
    (folder / "crashing.py").write_text(PLUGIN.replace("HOW", how))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(folder), *sys.path])}
    return subprocess.Popen(
        [sys.executable, "-c", "from harness.cli.main import entry; entry()", *words,
         "--plugin", "crashing.py"],
        cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


@pytest.mark.nightly(but=["SIGSEGV"])
@pytest.mark.parametrize("name", ["SIGSEGV", "SIGABRT", "SIGBUS"])
def test_a_crash_is_an_error_that_names_the_file(folder, name):
    process = command(folder, f"os.kill(os.getpid(), signal.{name})", "check", "a.scenario.yaml")
    _, said = process.communicate(timeout=HANG)
    assert process.returncode == 3
    assert f"a native library crashed ({name}); it read '{folder / 'thing.stl'}' last" in said


@pytest.mark.nightly(but=["15"])
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_to_the_command_ends_both_processes(folder, number):
    process = command(folder, WAIT, "check", "a.scenario.yaml")
    wait_for(lambda: (folder / "waits").exists())
    process.send_signal(number)
    _, said = process.communicate(timeout=HANG)
    assert process.returncode == 130
    assert "Traceback" not in said


@pytest.mark.nightly
def test_a_killed_command_leaves_no_process(folder):
    how = "Path('waits').write_text(str(os.getpid())); signal.pause()"
    process = command(folder, how, "check", "a.scenario.yaml")
    wait_for(lambda: (folder / "waits").exists() and (folder / "waits").read_text())
    child = int((folder / "waits").read_text())
    assert child != process.pid
    process.kill()
    process.communicate(timeout=HANG)

    def is_gone():
        try:
            os.kill(child, 0)
        except ProcessLookupError:
            return True
        return False

    assert wait_for(is_gone)
