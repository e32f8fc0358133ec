"""Commands in processes of their own, forked from one that has imported the libraries."""

import atexit
import os
import signal
import socket
import subprocess
import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from harness.suite import warm
from harness.suite.cases import read_ahead
from harness.suite.environment import server_environment
from harness.suite.server import Server, send
from harness.suite.warm import REPORT_MODULES, RUN_MODULES, Ended, WarmServer
from tests.beginning import as_before_tests

ROBOTS = frozenset({"open_manipulator_x"})
"""Bundled robots that most scenarios of tests name."""


@cache
def server() -> WarmServer:
    made = WarmServer(["harness.cli.main", *RUN_MODULES, *REPORT_MODULES, "tests.commands"])
    made.prepare(read_ahead, ROBOTS)
    atexit.register(made.close)
    return made


def forked(function, *arguments) -> Ended:
    """The end of a process that calls a function, which has the name of a module's."""
    with as_before_tests():
        job = server().start(function, *arguments)
    while True:
        for event in server().wait(None):
            if isinstance(event, Ended) and event.job == job:
                return event


def harness(*words, cwd, **environment) -> subprocess.CompletedProcess[str]:
    """A command that ended; its modules come from the paths of `PYTHONPATH` first."""
    words = [str(word) for word in words]
    with TemporaryDirectory() as folder:
        out, err = Path(folder, "out"), Path(folder, "err")
        end = forked(_command, words, str(cwd), {**os.environ, **environment}, out, err)
        assert server().pid is not None, "the server ended"
        text = [file.read_text(encoding="utf-8") for file in (out, err)]
    return subprocess.CompletedProcess(words, end.code or 0, *text)


def run(file, options, _notify):
    """The outcome of one case of a file, for `forked`."""
    from tests.running import run_case

    return run_case(file, **options).outcome


class _Process:
    """The process of a fork server, as far as `WarmServer` uses the one that it starts."""

    def __init__(self, pid):
        self.pid = pid

    def wait(self, _timeout=None):
        return os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])

    def kill(self):
        os.kill(self.pid, signal.SIGKILL)


class _ForkedServer(WarmServer):
    """The server of a command: forked from this process, which has its modules, not started."""

    def open(self):
        if self._process is not None:
            return
        self._control, theirs = socket.socketpair()
        if pid := os.fork():
            theirs.close()
            self._process = _Process(pid)
            return
        try:
            self._control.close()
            _serve(theirs)
        finally:
            os._exit(1)


def _serve(control):
    os.setsid()
    nothing = os.open(os.devnull, os.O_RDWR)
    for number in range(3):
        os.dup2(nothing, number)
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    environment = server_environment()
    os.environ.clear()
    os.environ.update(environment)
    send(control, ("ready",))
    Server(control).serve()


def _command(words, cwd, environment, out, err, _notify):
    from harness.cli.main import entry

    warm.WarmServer = _ForkedServer
    for file, number in ((out, 1), (err, 2)):
        with file.open("wb") as stream:
            os.dup2(stream.fileno(), number)
    os.chdir(cwd)
    os.environ.clear()
    os.environ.update(environment)
    paths = environment.get("PYTHONPATH", "").split(os.pathsep)
    sys.path[:0] = [cwd, *filter(None, paths)]
    sys.argv[:] = ["harness", *words]
    entry()
