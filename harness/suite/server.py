"""The warm fork server's own process: imports once, then forks a child for every job.

It talks over one Unix socket. It makes no threads and no GL context, so that a fork is safe, and
it never waits on anything but that socket and its children. `multiprocessing`'s own server runs
the caller's main module in every child, hides a failing import, and is one per process, shared
with whatever else the caller does; hence this one.

Messages in, pickled: ("prepare", callable, arguments) for what this process does before it forks
again, ("run", job, callable, arguments) with the descriptors of a pipe and of a log, ("kill", job).
Out: ("ready",), ("broken", why), ("started", job, pid), ("ended", job, code),
where a code below zero is a signal's number, as `subprocess` has it.
"""

from __future__ import annotations

import contextlib
import faulthandler
import gc
import importlib
import json
import os
import pickle
import selectors
import signal
import socket
import sys
import threading
import traceback
import warnings
from collections.abc import Callable, Sequence
from typing import Any

FRAME_BYTES = 8  # of a message's length in front of it
FDS_PER_JOB = 2  # a pipe for messages and a file for what is printed


def main() -> None:
    """Entry of the server process; its arguments: the socket's descriptor, sys.path, modules."""
    control = socket.socket(fileno=int(sys.argv[1]))
    sys.path[:] = json.loads(sys.argv[2])
    # A terminal's Ctrl-C is the caller's to handle; this process ends when its socket does.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    gc.disable()  # imports make objects that stay
    try:
        preload(json.loads(sys.argv[3]))
    except BaseException:  # noqa: BLE001 - the caller receives whatever an import raises
        send(control, ("broken", traceback.format_exc()))
        os._exit(1)
    gc.enable()
    share()
    send(control, ("ready",))
    Server(control).serve()


def share() -> None:
    """Keep the collector from writing into what is there, so that children share its pages.

    To collect first would take as long as a tenth of the imports, and find next to nothing.
    """
    gc.freeze()


def preload(modules: Sequence[str]) -> None:
    """Import what runs need; warnings of foreign modules are not the user's."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for name in modules:
            importlib.import_module(name)


def send(control: socket.socket, message: tuple[Any, ...], fds: Sequence[int] = ()) -> None:
    """Send a pickled message, with the descriptors attached to its first byte."""
    body = pickle.dumps(message)
    frame = len(body).to_bytes(FRAME_BYTES, "big") + body
    if fds:
        socket.send_fds(control, [frame[:1]], list(fds))
        frame = frame[1:]
    control.sendall(frame)


def receive(control: socket.socket) -> tuple[tuple[Any, ...], list[int]]:
    """Receive a message and its descriptors.

    Raises:
        EOFError: The other side is gone.
    """
    first, fds, _flags, _address = socket.recv_fds(control, 1, FDS_PER_JOB)
    for fd in fds:  # whoever reads them would wait for what the child leaves running
        os.set_inheritable(fd, False)
    head = first + _exactly(control, FRAME_BYTES - len(first)) if first else b""
    if not head:
        raise EOFError
    return pickle.loads(_exactly(control, int.from_bytes(head, "big"))), list(fds)


def _exactly(control: socket.socket, count: int) -> bytes:
    parts: list[bytes] = []
    while count:
        part = control.recv(count)
        if not part:
            raise EOFError
        parts.append(part)
        count -= len(part)
    return b"".join(parts)


class Server:
    """Forks, kills and reaps children until the caller hangs up."""

    def __init__(self, control: socket.socket) -> None:
        self._control = control
        self._jobs: dict[int, int] = {}  # pid -> job
        self._wakeup, signals = os.pipe()
        os.set_blocking(self._wakeup, False)
        os.set_blocking(signals, False)
        signal.signal(signal.SIGCHLD, lambda _number, _frame: None)
        signal.set_wakeup_fd(signals)

    def serve(self) -> None:
        selector = selectors.DefaultSelector()
        selector.register(self._control, selectors.EVENT_READ)
        selector.register(self._wakeup, selectors.EVENT_READ)
        try:
            while True:
                for key, _events in selector.select():
                    if key.fileobj is self._control:
                        self._obey()
                    else:
                        self._reap()
        except (EOFError, OSError):
            pass  # the caller is gone
        finally:
            for pid in self._jobs:
                _kill_group(pid)
            for pid in self._jobs:  # so that the caller finds none alive, nor half dead
                os.waitpid(pid, 0)
            os._exit(0)  # no interpreter's end: native libraries print about leaks there

    def _obey(self) -> None:
        message, fds = receive(self._control)
        match message:
            case ("kill", number):
                for pid, job in self._jobs.items():
                    if job == number:
                        _kill_group(pid)
            case ("prepare", call, arguments):
                _prepare(call, arguments)
            case (_run, job, call, arguments):
                self._fork(job, call, arguments, fds)
            case _:
                raise AssertionError(message)

    def _fork(self, job: int, call: bytes, arguments: bytes, fds: Sequence[int]) -> None:
        pid = os.fork()
        if pid == 0:
            self._control.close()
            _child(call, arguments, *fds)
        with contextlib.suppress(OSError):  # the child does the same; whoever is first
            os.setpgid(pid, pid)
        for fd in fds:
            os.close(fd)
        self._jobs[pid] = job
        send(self._control, ("started", job, pid))

    def _reap(self) -> None:
        with contextlib.suppress(BlockingIOError):
            os.read(self._wakeup, 4096)
        for pid in list(self._jobs):
            if not os.waitid(os.P_PID, pid, os.WEXITED | os.WNOHANG | os.WNOWAIT):
                continue
            _kill_group(pid)  # processes that the child started and did not end
            _pid, status = os.waitpid(pid, 0)
            send(self._control, ("ended", self._jobs.pop(pid), os.waitstatus_to_exitcode(status)))


def _prepare(call: bytes, arguments: bytes) -> None:
    """Do work once that every child would repeat; an error appears in the child that needs it."""
    with contextlib.suppress(Exception):
        pickle.loads(call)(*pickle.loads(arguments))
    share()


def _kill_group(pid: int) -> None:
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(pid, signal.SIGKILL)


def _child(call: bytes, arguments: bytes, pipe: int, log: int) -> None:
    """Run one job in the fresh child; everything it prints goes to its log."""
    code = 1
    try:
        os.setpgid(0, 0)
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        nothing = os.open(os.devnull, os.O_RDONLY)
        os.dup2(nothing, 0)
        os.dup2(log, 1)
        os.dup2(log, 2)
        faulthandler.enable()  # a native crash leaves its Python lines in the log
        from multiprocessing.connection import Connection

        with Connection(pipe, readable=False) as connection:
            sending = threading.Lock()
            try:

                def notify(message: object) -> None:
                    with sending:
                        connection.send(("heard", message))

                function: Callable[..., Any] = pickle.loads(call)
                result = function(*pickle.loads(arguments), notify)
                connection.send(("result", result))
                code = 0
            except BaseException as error:  # noqa: BLE001 - the child's last words
                from harness.core.error_text import error_text

                connection.send(("raised", error_text(error)))
        sys.stdout.flush()
        sys.stderr.flush()
    finally:
        os._exit(code)
