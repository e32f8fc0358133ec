"""Commands in processes of their own, forked from one that has imported the libraries.

Commands in the process of a test start a fork server, which takes over a second to import these
libraries; with `servers_are("forked")` it is forked, too.
"""

import atexit
import contextlib
import os
import select
import signal
import socket
import subprocess
import sys
import traceback
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from harness.suite import warm
from harness.suite.cases import read_ahead
from harness.suite.environment import server_environment, use_one_thread
from harness.suite.server import Server, preload, send, share
from harness.suite.warm import REPORT_MODULES, RUN_MODULES, Ended, WarmServer
from tests.beginning import as_before_tests
from tests.waiting import HANG

ROBOTS = frozenset({"open_manipulator_x"})
"""Bundled robots that most scenarios of tests name."""

PID_BYTES = 4


_start = WarmServer.open


class _StartedServer(WarmServer):
    """A server that is started, also where others are forked from it."""

    def open(self):
        _start(self)


@cache
def server() -> WarmServer:
    made = _StartedServer(["harness.cli.main", *RUN_MODULES, *REPORT_MODULES, "tests.commands"])
    with as_before_tests():
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


@contextlib.contextmanager
def servers_are(kind):
    """Have the fork servers of this process "started", or "forked" from the one of the tests."""
    before = WarmServer.open
    WarmServer.open = {"started": _start, "forked": _ServerOfTests.open}[kind]
    try:
        yield
    finally:
        WarmServer.open = before


class _ServerOfTests(WarmServer):
    """A server that is forked from the one of the tests."""

    def open(self):
        if self._process is not None:
            return
        use_one_thread()
        self._is_ready = False
        paths = [str(Path(entry).absolute()) for entry in sys.path]
        state = (str(Path.cwd()), server_environment(), paths, self._modules)
        with socket.socket(socket.AF_UNIX) as listener:
            listener.settimeout(HANG)
            listener.bind("")  # the kernel gives a name; the path of a test's folder may be long
            listener.listen(1)
            server().start(_serve_at, listener.getsockname(), *state)
            self._control, _ = listener.accept()
            pid = int.from_bytes(self._control.recv(PID_BYTES), "big")
        self._process = _OtherProcess(pid)


class _OtherProcess:
    """The process of a fork server that is no child of this one."""

    def __init__(self, pid):
        self.pid = pid
        self._end = os.pidfd_open(pid)

    def wait(self, timeout=None):
        if not select.select([self._end], [], [], timeout)[0]:
            raise subprocess.TimeoutExpired("fork server", timeout)
        return 0

    def kill(self):
        with contextlib.suppress(ProcessLookupError):
            signal.pidfd_send_signal(self._end, signal.SIGKILL)

    def __del__(self):
        os.close(self._end)


def _serve_at(place, folder, environment, paths, modules, _notify):
    control = socket.socket(socket.AF_UNIX)
    control.connect(place)
    control.sendall(os.getpid().to_bytes(PID_BYTES, "big"))
    os.chdir(folder)
    sys.path[:] = paths
    _serve(control, environment, modules)


class ForkedServer(WarmServer):
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
            os.setsid()
            _serve(theirs, server_environment(), ())
        finally:
            os._exit(1)


def _serve(control, environment, modules):
    nothing = os.open(os.devnull, os.O_RDWR)
    for number in range(3):
        os.dup2(nothing, number)
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.environ.clear()
    os.environ.update(environment)
    try:
        preload(modules)
    except BaseException:  # noqa: BLE001 - as in `harness.suite.server`
        send(control, ("broken", traceback.format_exc()))
        os._exit(1)
    share()
    send(control, ("ready",))
    Server(control).serve()


def _command(words, cwd, environment, out, err, _notify):
    from harness.cli.main import entry

    warm.WarmServer = ForkedServer
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
