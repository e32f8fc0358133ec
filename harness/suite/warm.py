"""The caller's side of the warm fork server: start jobs, hear from them, end them."""

from __future__ import annotations

import contextlib
import json
import os
import pickle
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import IO, Any

from harness.core.errors import HarnessError
from harness.core.registry import registry
from harness.suite.environment import server_environment, use_one_thread
from harness.suite.server import receive, send

RUN_MODULES = (
    "harness.planning.ik.solvers.numeric",
    "harness.planning.search.pipelines.ompl",
    "harness.session.run_case",
    "harness.simulation.mujoco_simulator",
    "harness.simulation.controllers.position_servo",
    "harness.session.observation.clearance",
    "harness.session.observation.link_overlaps",
    "numpy.random",
    "pinocchio",
    "coal",
)
"""What every run imports until its outcome is known."""

REPORT_MODULES = (
    "harness.cameras.meshes",
    *registry("camera_recorder").built_in_modules.values(),
    "harness.reporting.html.write",
    "jinja2",
    "numpy.ma",
)
"""What a report needs besides; a single case imports it after its outcome is known."""

STOP_SECONDS = 5.0  # of wall time until a server that does not end is killed
LOG_TAIL_BYTES = 4000  # a screen of what a process printed last


class ServerStartError(HarnessError):
    """The fork server cannot start; carries why."""


@dataclass(frozen=True)
class Heard:
    """Something a running job sent."""

    job: int
    message: Any


@dataclass(frozen=True)
class Ended:
    """A job is over.

    Attributes:
        result: What its function returned; None unless `code` is 0.
        code: 0; 1 when the function raised; minus a signal's number; None when the server died.
        log: The end of what the process and its libraries printed.
    """

    job: int
    result: Any
    code: int | None
    traceback: str
    log: str


@dataclass
class _Running:
    pipe: Connection
    log: IO[bytes]
    pid: int = 0
    begin: float = 0.0
    code: int | None = None
    has_ended: bool = False
    result: Any = None
    traceback: str = ""
    at_eof: bool = False
    heard: list[Any] = field(default_factory=list[Any])


class WarmServer:
    """A process that has imported `modules` and forks a child for every job.

    It starts with the first job and ends, with all its children, with `close`, or when this
    process dies in whatever way.
    """

    def __init__(self, modules: Sequence[str] = RUN_MODULES) -> None:
        self._modules = tuple(modules)
        self._process: subprocess.Popen[bytes] | None = None
        self._control: socket.socket | None = None
        self._is_ready = False
        self._jobs: dict[int, _Running] = {}
        self._count = 0

    def __enter__(self) -> WarmServer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def pid(self) -> int | None:
        """Process ID of the server; None before the first job."""
        return self._process.pid if self._process else None

    def open(self) -> None:
        """Start the server, if it is not there, without waiting for its imports."""
        if self._process is not None:
            return
        use_one_thread()
        self._is_ready = False
        self._control, theirs = socket.socketpair()
        code = "import sys, json; sys.path[:] = json.loads(sys.argv[2]); "
        code += "from harness.suite.server import main; main()"
        paths = json.dumps([str(Path(entry).absolute()) for entry in sys.path])
        with theirs:
            self._process = subprocess.Popen(  # own session: Ctrl-C reaches only the caller
                [sys.executable, "-P", "-c", code,
                 str(theirs.fileno()), paths, json.dumps(self._modules)],
                stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                pass_fds=[theirs.fileno()], start_new_session=True, env=server_environment(),
            )  # fmt: skip

    def prepare(self, function: Callable[..., None], *arguments: object) -> None:
        """Let the server itself do something before its next fork; every later job finds it done.

        The function must end all its threads; its exceptions are ignored.
        """
        self.open()
        assert self._control is not None
        with contextlib.suppress(OSError):  # the server is gone: `wait` reports it
            send(self._control, ("prepare", pickle.dumps(function), pickle.dumps(arguments)))

    def start(self, function: Callable[..., Any], *arguments: object) -> int:
        """Run `function(*arguments, notify)` in a child; the function is found by its name there.

        Returns:
            The job's number, as in the events of `wait`.
        """
        self.open()
        assert self._control is not None
        reading, writing = os.pipe()
        log = tempfile.TemporaryFile()  # noqa: SIM115 - closed when the job ends
        self._count += 1
        self._jobs[self._count] = _Running(Connection(reading, writable=False), log)
        message = ("run", self._count, pickle.dumps(function), pickle.dumps(arguments))
        try:
            send(self._control, message, [writing, log.fileno()])
        except OSError:
            pass  # the server is gone: `wait` reports it
        finally:
            os.close(writing)
        return self._count

    def kill(self, job: int) -> None:
        """Kill a job's process and its children; `wait` reports the end."""
        if self._control is not None and job in self._jobs:
            with contextlib.suppress(OSError):
                send(self._control, ("kill", job))

    def time_of(self, job: int) -> float:
        """Wall time since a job began, without waits for a processor where Linux has them [s]."""
        running = self._jobs.get(job)
        if running is None or not running.pid:
            return 0.0
        passed = time.monotonic() - running.begin
        try:
            stated = Path(f"/proc/{running.pid}/schedstat").read_text(encoding="ascii")
        except OSError:
            return passed
        return passed - int(stated.split()[1]) / 1e9

    def wait(self, timeout: float | None) -> Iterator[Heard | Ended]:
        """Yield what happened, or nothing when `timeout` seconds passed first.

        Raises:
            ServerStartError: The server could not import its modules.
        """
        assert self._control is not None
        open_pipes = [running.pipe for running in self._jobs.values() if not running.at_eof]
        ready = wait([self._control, *open_pipes], timeout)
        if self._control in ready:
            self._hear_server()
        for job, running in list(self._jobs.items()):
            if running.pipe in ready:
                _drain(running)
            for message in running.heard:
                yield Heard(job, message)
            running.heard.clear()
            if running.has_ended and running.at_eof:
                del self._jobs[job]
                yield _ended(job, running)

    def close(self) -> None:
        if self._process is None or self._control is None:
            return
        self._control.close()
        try:
            self._process.wait(STOP_SECONDS)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
            self._kill_orphans()
        for running in self._jobs.values():
            running.pipe.close()
            running.log.close()
        self._jobs.clear()
        self._process = self._control = None

    def _hear_server(self) -> None:
        assert self._control is not None
        try:
            message, _fds = receive(self._control)
        except (EOFError, OSError):
            return self._server_died()
        match message:
            case ("ready",):
                self._is_ready = True
            case ("broken", why):
                self.close()
                raise ServerStartError(f"the modules of a run cannot be imported\n{why}")
            case ("started", job, pid):
                self._jobs[job].pid, self._jobs[job].begin = pid, time.monotonic()
            case ("ended", job, code):
                self._jobs[job].code, self._jobs[job].has_ended = code, True
            case _:
                raise AssertionError(message)
        return None

    def _server_died(self) -> None:
        assert self._process is not None
        assert self._control is not None
        self._control.close()
        self._process.kill()
        code = self._process.wait()
        self._process = self._control = None
        self._kill_orphans()
        if not self._is_ready:
            raise ServerStartError(
                f"the process that imports the modules of a run ended with code {code}"
            )
        for running in self._jobs.values():
            running.has_ended = running.at_eof = True

    def _kill_orphans(self) -> None:
        for running in self._jobs.values():
            if running.pid and not running.has_ended:
                with contextlib.suppress(ProcessLookupError, PermissionError):
                    os.killpg(running.pid, signal.SIGKILL)


def _drain(running: _Running) -> None:
    """Take in everything that stands in a job's pipe."""
    try:
        while running.pipe.poll():
            kind, payload = running.pipe.recv()
            if kind == "result":
                running.result = payload
            elif kind == "raised":
                running.traceback = payload
            else:
                running.heard.append(payload)
    except (EOFError, OSError):  # its writer is gone, perhaps in the middle of a message
        running.at_eof = True


def _ended(job: int, running: _Running) -> Ended:
    running.pipe.close()
    with running.log as log:
        size = log.seek(0, os.SEEK_END)
        log.seek(max(0, size - LOG_TAIL_BYTES))
        text = log.read().decode(errors="replace")
    code = running.code
    if code == 0 and running.result is None:
        code = None
    return Ended(job, running.result, code, running.traceback, text)
