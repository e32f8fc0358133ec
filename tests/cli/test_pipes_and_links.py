"""Pipes and links in place of files: a pipe is never waited for, and a link leads nowhere."""

import contextlib
import os
import shutil
import threading

import pytest

from tests.commands import harness
from tests.running import exit_code

SCENARIO = """\
scenario: A
robot: open_manipulator_x
params: {x: 0.1}
randomize: {x: {uniform: [0.1, 0.2]}}
samples: 2
steps: [{move_to: {joints: {joint1: "${x}"}}}]
expect: [{always: within_limits}]
"""


@pytest.fixture
def folder(tmp_path, monkeypatch, recorded_run):
    monkeypatch.chdir(tmp_path)
    text = SCENARIO.replace("samples: 2\n", "").replace("randomize", "#")
    shutil.copytree(recorded_run(text, stills=True) / "run", tmp_path / "run")
    (tmp_path / "a.scenario.yaml").write_text(SCENARIO)
    return tmp_path


@contextlib.contextmanager
def pipe(path):
    """A pipe, whose readers find it empty, so that one who waits goes on."""
    path.unlink(missing_ok=True)
    os.mkfifo(path)
    end = threading.Event()

    def write():
        while not end.wait(0.05):
            with contextlib.suppress(OSError):  # it has no reader
                os.close(os.open(path, os.O_WRONLY | os.O_NONBLOCK))

    writer = threading.Thread(target=write)
    writer.start()
    try:
        yield
    finally:
        end.set()
        writer.join()


@pytest.mark.parametrize(
    ("file", "words"),
    [
        ("run/signals.npz", ["judge", "run"]),
        ("c.jsonl", ["run", "a.scenario.yaml", "--no-report", "--conditions", "c.jsonl"]),
    ],
)
def test_a_pipe_is_refused_where_a_file_is_read(file, words, folder, capsys):
    with pipe(folder / file):
        assert exit_code(*words) == 2
    said = capsys.readouterr().err
    assert file.rpartition("/")[2] in said
    assert "not a regular file" in said


def test_a_pipe_is_no_scenario(folder, capsys):
    with pipe(folder / "x.scenario.yaml"):
        assert exit_code("check", "x.scenario.yaml") == 2
    assert "'x.scenario.yaml' is neither a file nor a folder" in capsys.readouterr().err


def test_a_submission_that_is_a_pipe_costs_that_submission_alone(tmp_path):
    from harness.plugins.grading.classroom.submissions import (
        SubmissionError,
        one_submission,
        unpack,
    )

    with pipe(tmp_path / "a.py"), pytest.raises(SubmissionError, match="not a regular file"):
        unpack(one_submission(tmp_path / "a.py"), tmp_path / "target", 1)


@pytest.mark.parametrize("is_link", [True, False], ids=["link", "pipe"])
def test_a_page_is_written_in_place_of_a_link_or_a_pipe(is_link, folder):
    page, other = folder / "run/report.html", folder / "precious"
    page.unlink(missing_ok=True)
    other.write_text("years of work")
    if is_link:
        page.symlink_to(other)
    else:
        os.mkfifo(page)
    assert exit_code("view", "--rebuild", "--no-open", "run") == 0
    assert other.read_text() == "years of work"
    assert page.is_file()
    assert not page.is_symlink()


def test_a_still_that_links_out_of_the_run_is_not_shown(folder, capsys):
    still = next((folder / "run/images").glob("01-*.jpg"))
    shutil.move(still, folder / "private.jpg")
    still.symlink_to(folder / "private.jpg")
    assert exit_code("view", "--rebuild", "--no-open", "run") == 2
    assert "leads out of the run's folder" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words",
    [["check", "a.scenario.yaml"], ["run", "a.scenario.yaml", "--no-report"], ["schema"]],
)
def test_a_module_that_is_a_pipe_without_a_writer_is_not_waited_for(words, folder):
    os.mkfifo(folder / "p.py")
    ended = harness(*words, "--plugin", "p.py", cwd=folder)
    assert ended.returncode == 2
    assert "p.py is no regular Python file" in ended.stderr


@pytest.mark.parametrize(
    "words", [["schema", "--write", "out"], ["export", "run", "--force", "--urdf", "out"]]
)
def test_a_pipe_without_a_reader_is_not_written_to(words, folder):
    os.mkfifo(folder / "out")
    ended = harness(*words, cwd=folder)
    assert ended.returncode == 2
    assert "out" in ended.stderr
    assert "Traceback" not in ended.stderr


def test_a_pipe_with_a_reader_is_written_to(folder):
    os.mkfifo(folder / "out")
    reader = os.open(folder / "out", os.O_RDONLY | os.O_NONBLOCK)
    try:
        assert harness("export", "run", "--force", "--urdf", "out", cwd=folder).returncode == 0
        assert os.read(reader, 5) == b"<?xml"
    finally:
        os.close(reader)


@pytest.mark.parametrize(
    "words",
    [
        ["import", "sdf", "loop", "-o", "w.yaml"],
        ["import", "mjcf", "w.xml", "-o", "loop", "--force"],
        ["new", "--project", "loop"],
    ],
)
def test_a_loop_of_links_is_named(words, folder, capsys):
    (folder / "loop").symlink_to("loop")
    (folder / "w.xml").write_text(
        "<mujoco><worldbody><geom type='box' size='1 1 1'/></worldbody></mujoco>"
    )
    assert exit_code(*words) == 2
    said = capsys.readouterr().err
    assert "loop" in said
    assert "Traceback" not in said


def test_the_server_of_assistants_does_not_wait_for_a_pipe(tmp_path):
    from harness.plugins.mcp.workspace import RefusedError, Workspace

    os.mkfifo(tmp_path / "a.yaml")
    with pytest.raises(RefusedError, match="not a regular file"):
        Workspace(tmp_path).read("a.yaml")
