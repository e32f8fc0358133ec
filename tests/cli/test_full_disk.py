"""A disk that is full while a command writes: the older file stays whole, and no half of a new."""

import contextlib
import io
import resource
import shutil
import signal
import sys

import pytest

from tests.running import exit_code

SCENARIO = """\
scenario: A
robot: open_manipulator_x
steps: [{wait: 5 ms}]
expect: [{always: within_limits}]
"""
MOST = 500  # bytes that a file may have
REPLACED = {
    "x.json": ["schema", "--write"],
    "x.urdf": ["export", "RUN", "--force", "--urdf"],
    "x.html": ["compare", "RUN", "RUN", "--page"],
    "x.png": ["robot", "show", "open_manipulator_x", "--image"],
    "x.srdf": [
        "robot",
        "check",
        "open_manipulator_x",
        "--samples",
        "100",
        "--force",
        "--write-srdf",
    ],
    "report.html": ["view", "--no-open", "--rebuild"],
}
NEW = {
    "new": ["new"],
    "project": ["new", "--project"],
    "course": ["course", "start", "1"],
    "mcap": ["export", "RUN", "--bag"],
    "sqlite3": ["export", "RUN", "--storage", "sqlite3", "--bag"],
}


@contextlib.contextmanager
def full_disk():
    """No file of this process and its children grows beyond some bytes.

    Python writes no modules meanwhile: 3.11 takes half of one for the whole, now and later.
    """
    writes_none, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (MOST, limit[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
        signal.signal(signal.SIGXFSZ, ignored)
        sys.dont_write_bytecode = writes_none


@pytest.fixture(scope="module")
def run(recorded_run):
    return recorded_run(SCENARIO) / "run"


@pytest.fixture
def command(run, tmp_path):
    """`command(*words)`: exit code and errors of a command on a full disk, with a copy of a run."""
    shutil.copytree(run, tmp_path / "run")
    (tmp_path / "out").mkdir()

    def end(*words):
        words = [word.replace("RUN", str(tmp_path / "run")) for word in words]
        with full_disk(), contextlib.redirect_stderr(io.StringIO()) as said:
            code = exit_code(*words)
        return code, said.getvalue()

    return end


@pytest.mark.parametrize("name", REPLACED)
def test_an_older_file_stays_where_a_new_one_does_not_fit(name, command, tmp_path):
    *words, last = REPLACED[name]
    file = tmp_path / ("run" if last == "--rebuild" else "out") / name
    file.write_text("older")
    before = sorted(tmp_path.rglob("*"))
    place = str(tmp_path / "run") if last == "--rebuild" else str(file)
    code, said = command(*words, last, place)
    assert code == 2, said
    assert f"'{file}'" in said
    assert "File too large" in said
    assert "Traceback" not in said
    assert file.read_text() == "older"
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("name", NEW)
def test_nothing_is_left_where_a_new_file_or_folder_does_not_fit(name, command, tmp_path):
    code, said = command(*NEW[name], str(tmp_path / "out" / name))
    assert code in (2, 3)
    assert name in said
    assert "Traceback" not in said
    assert [each for each in (tmp_path / "out").rglob("*") if each.is_file()] == []
