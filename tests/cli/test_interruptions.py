"""Commands that are interrupted, killed, or have nowhere to write to."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from harness.suite.leftovers import clean_leftovers
from tests.cli.run_in_terminal import HARNESS, run_in_terminal
from tests.gate import PLUGIN, Gate
from tests.waiting import HANG, is_alive, wait_for

LONG = """\
scenario: Long
robot: open_manipulator_x
steps:
  - wait: 0.1 s
  - STEP
    id: sleep
expect:
  - duration: {at_least: 1 s}
"""
SCRIPT = [sys.executable, "-c", "from harness.cli.main import entry; entry()"]
WIDE = 200
"""Columns that hold a line of progress, however long the estimate of the time left is."""
SHORT = LONG.replace("STEP", "wait: 0.1 s")


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "long.scenario.yaml").write_text(LONG.replace("STEP", Gate(tmp_path).step))
    (tmp_path / "short.scenario.yaml").write_text(SHORT)
    return tmp_path


def once(words, number):
    """Send a signal when a command has written some words."""
    sent = []

    def send(process, text):
        if words in text and not sent:
            sent.append(number)
            process.send_signal(number)

    return send


@pytest.mark.nightly(but=["2"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_interrupted_run_says_where_it_stood(folder, number):
    session = run_in_terminal(
        ["run", "long.scenario.yaml", *PLUGIN], folder, on_text=once("2/2  hold", number)
    )
    assert session.code == 130, session.text
    said = " ".join(session.text.split())
    assert re.search(
        r"interrupted after [\d.]+ s, during step 2/2: hold at the gate: the run did", said
    )
    assert "Traceback" not in said
    assert "0 cases" not in said
    assert not list(folder.glob("reports/**/.*")), "nothing half written"


@pytest.mark.nightly
def test_an_interrupted_suite_counts_what_is_missing(folder):
    session = run_in_terminal(
        ["run", "short.scenario.yaml", "long.scenario.yaml", "--no-page", *PLUGIN],
        folder, columns=WIDE, on_text=once("2/2  hold", signal.SIGTERM),
    )  # fmt: skip
    assert session.code == 130
    lines = "\n".join(session.lines)
    assert "1 failed of 1 case" in lines
    assert re.search(r"interrupted after [\d.]+ s: 1 of 2 runs did not finish", lines)
    assert "long.scenario.yaml: during step 2/2: hold at the gate" in lines
    assert "--resume" in lines


@pytest.mark.nightly
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("option", ["--no-report", "--in-process"])
def test_a_signal_at_any_moment_ends_a_command_without_a_traceback(folder, number, option):
    for delay in (0.02, 0.05, 0.1, 0.15, 0.25, 0.3, 0.4, 0.5, 0.6, 1.2):
        with subprocess.Popen(
            [*SCRIPT, "run", "long.scenario.yaml", option, *PLUGIN], cwd=folder,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        ) as process:  # fmt: skip
            time.sleep(delay)
            process.send_signal(number)
            said, _ = process.communicate(timeout=HANG)
        if b"in entry" not in said and process.returncode in (-number, 1):
            continue  # Python was still starting or importing; nothing of the program had run
        assert process.returncode == 130, (delay, said)
        assert b"Traceback" not in said, (delay, said)


IMPORTS = """\
import signal, sys, time
from harness.core.interruption import RETRY_SECONDS, interrupt
signal.signal(signal.SIGINT, interrupt)
sys.path.insert(0, ".")
try:
    import interrupted_module
    while True:
        pass
except KeyboardInterrupt:
    time.sleep(3 * RETRY_SECONDS)  # nothing interrupts it once more
    print("module" if "interrupted_module" not in sys.modules else "after it")
"""


@pytest.mark.parametrize(("signals", "where"), [(1, "after it"), (2, "module")])
def test_the_first_signal_waits_for_the_end_of_an_import(folder, signals, where):
    module = "import os, signal\n" + "os.kill(os.getpid(), signal.SIGINT)\n" * signals
    (folder / "interrupted_module.py").write_text(module)
    done = subprocess.run(
        [sys.executable, "-c", IMPORTS],
        cwd=folder, capture_output=True, text=True, check=False, timeout=HANG,
    )  # fmt: skip
    assert (done.stdout.strip(), done.stderr) == (where, "")


LATE = """\
import os, signal, sys
from harness.cli.main import entry
class Late:
    def __init__(self, stream):
        self._stream = stream
    def __getattr__(self, name):
        return getattr(self._stream, name)
    def flush(self):
        self._stream.flush()
        os.kill(os.getpid(), {number})
        os.getpid()
sys.stdout = Late(sys.stdout)
sys.argv[1:] = {words}
entry()
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("words", [["list", "planners"], ["--version"]])
def test_signals_while_the_last_words_are_written_end_a_command(words, number):
    """One at each attempt to write them."""
    done = subprocess.run(
        [sys.executable, "-c", LATE.format(number=int(number), words=words)],
        capture_output=True, text=True, check=False, timeout=HANG,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (130, "")


IGNORED = """\
import os, signal, time, weakref
from harness.core.interruption import interrupt
signal.signal(signal.SIGINT, interrupt)
class Thing:
    pass
def stop(*_):
    os.kill(os.getpid(), signal.SIGINT)
    pass
try:
    {act}
    time.sleep(60)
except KeyboardInterrupt:
    print("interrupted")
"""
ACTS = {
    "fork": "os.register_at_fork(after_in_parent=stop); os.fork() or os._exit(0)",
    "end of an object": "Thing.__del__ = stop; Thing()",
    "weak reference": "thing = Thing(); kept = weakref.ref(thing, stop); del thing",
}


@pytest.mark.parametrize("act", ACTS.values(), ids=ACTS)
def test_a_signal_is_not_lost_where_python_ignores_exceptions(act):
    done = subprocess.run(
        [sys.executable, "-c", IGNORED.format(act=act)],
        capture_output=True, text=True, check=False, timeout=HANG,
    )  # fmt: skip
    assert (done.stdout.strip(), done.stderr) == ("interrupted", "")


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("redirection", "code"),
    [(">&-", 1), ("2>&-", 1), ("<&-", 1), ("<&- >&- 2>&-", 1), (">/dev/full", 3),
     ("2>/dev/full", 1), (">/dev/full 2>&1", 3)],
)  # fmt: skip
def test_a_stream_that_takes_nothing_is_no_failed_scenario(folder, redirection, code):
    words = " ".join(HARNESS)
    done = subprocess.run(
        f"{words} run short.scenario.yaml --no-report {redirection}",
        cwd=folder, shell=True, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == code, done.stderr
    assert "Traceback" not in done.stdout + done.stderr
    if redirection == ">/dev/full":
        assert "standard output cannot be written: No space left on device" in done.stderr


@pytest.mark.nightly(but=["1-list planners"])
@pytest.mark.parametrize("command", ["--help", "list planners", "check short.scenario.yaml --json"])
@pytest.mark.parametrize("is_unbuffered", ["1", ""])
def test_no_command_that_cannot_write_says_failed(folder, command, is_unbuffered):
    done = subprocess.run(
        f"{' '.join(HARNESS)} {command} >/dev/full",
        cwd=folder, shell=True, capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONUNBUFFERED": is_unbuffered},
    )  # fmt: skip
    assert done.returncode == 3
    assert done.stderr == ("harness: standard output cannot be written: No space left on device\n")


@pytest.mark.nightly
@pytest.mark.parametrize("library", ["xyz", "osmesa", "egl", "disable"])
def test_a_graphics_library_that_is_missing_stops_no_run(folder, library):
    for more in ([], ["--in-process"]):
        done = subprocess.run(
            [*HARNESS, "run", "short.scenario.yaml", *more],
            cwd=folder, capture_output=True, text=True, check=False,
            env={**os.environ, "MUJOCO_GL": library},
        )  # fmt: skip
        assert done.returncode == 1, done.stderr
        assert "1 failed of 1 case" in done.stdout
        assert done.stderr == ""


def leftover(folder, name, pid, kind="writing"):
    place = folder / f".{name}.{kind}.{pid}.0"
    (place / "images").mkdir(parents=True)
    (place / "run.json").write_text("{}")
    return place


def dead_process():
    with subprocess.Popen(["true"]) as process:
        process.wait()
    return process.pid


def test_a_run_cleans_what_killed_runs_of_its_case_left(folder):
    reports = folder / "reports"
    dead = dead_process()
    gone = leftover(reports, "short", dead)
    alive = leftover(reports, "short", os.getpid())
    kept = leftover(reports, "other", dead)
    older = reports / f".short.old.{dead}.1" / "short"
    older.mkdir(parents=True)
    (older / "run.json").write_text("{}")
    clean_leftovers(reports / "short")
    assert not gone.exists()
    assert not older.parent.exists()
    assert alive.exists()
    assert kept.exists(), "it is cleaned when its own case is run"
    assert (reports / "short" / "run.json").is_file(), "the older report has its place again"


@pytest.mark.nightly
def test_a_killed_run_leaves_nothing_after_the_next_one(folder):
    gate = Gate(folder)
    with subprocess.Popen(
        [*HARNESS, "run", "short.scenario.yaml", *gate.reporter], cwd=folder,
        stdout=subprocess.DEVNULL,
    ) as process:  # fmt: skip
        gate.wait()
        [found] = Path(folder, "reports").glob(".short.writing.*")
        process.kill()
    writer = int(found.name.split(".")[3])
    wait_for(lambda: not is_alive(writer))
    assert found.exists()
    clean_leftovers(folder / "reports" / "short")
    assert not found.exists()


def test_a_process_that_has_ended_writes_no_longer(folder):
    with subprocess.Popen(["true"]) as zombie:
        os.waitid(os.P_PID, zombie.pid, os.WEXITED | os.WNOWAIT)
        gone = leftover(folder / "reports", "short", zombie.pid)
        clean_leftovers(folder / "reports" / "short")
        assert not gone.exists()
