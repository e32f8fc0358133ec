"""Functions under test with one interface: in a process of their own, or in this one."""

from __future__ import annotations

import os
import re
import signal
import socket
from collections.abc import Callable, Mapping
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, Protocol

from harness.core.socket_folder import socket_folder, socket_parent
from harness.plugins.iktest.calls import CallOutcome, call
from harness.plugins.iktest.contract import UnusableSolver, Value, parameter_words
from harness.plugins.iktest.worker import serve
from harness.robot.robot_source import RobotSource
from harness.suite.leftovers import remove_abandoned
from harness.suite.warm import Ended, WarmServer

PREFIX = "harness-ik-"  # how the names of folders begin; the number of the process follows

IMPORT_SECONDS = 60.0  # wall time that importing the function may take

POLL_SECONDS = 0.02

WAITING_LIMIT = 10.0  # wall time per processor time of a call: a busy machine makes none hang


class Solver(Protocol):
    """A function under test.

    Attributes:
        words: Names of the parameters that it is given.
    """

    name: str
    words: tuple[str, ...]

    def __call__(self, arguments: Mapping[str, Value]) -> CallOutcome:
        """Call the function."""
        ...

    def close(self) -> None:
        """End the process of the function."""
        ...


class InProcess:
    """A function called here; if it hangs or kills the process, so it does here."""

    def __init__(self, function: Callable[..., Any], dof: int) -> None:
        self.name = getattr(function, "__name__", "ik")
        self.words = parameter_words(function)
        self._function, self._dof = function, dof

    def __call__(self, arguments: Mapping[str, Value]) -> CallOutcome:
        """Call the function."""
        return call(self._function, arguments, self._dof)

    def close(self) -> None:
        """Release nothing: the function runs in this process."""


class Isolated:
    """A function in a process of its own, which is ended when a call takes too long.

    A process that has ended, in whatever way, is followed by a new one at the next call.
    """

    def __init__(self, name: str, robot: RobotSource, tip: str, dof: int, patience: float) -> None:
        """Start the process.

        Args:
            name: The name as `find_function` takes it, that of a registered solver, or `own`.
            tip: The link that is placed; empty for the TCP.
            dof: The number of the arm's joints.
            patience: Processor time that a call may take [s].

        Raises:
            UnusableSolver: The function cannot be imported or called.
        """
        self.name = name.rpartition(":")[2]
        self._job = 0
        self._arguments = (name, robot, tip, dof)
        self._patience = patience
        remove_abandoned(PREFIX, socket_parent())
        self._folder = socket_folder(f"{PREFIX}{os.getpid()}-")
        address = Path(self._folder.name) / "socket"
        self._socket = socket.socket(socket.AF_UNIX)
        self._socket.bind(str(address))
        self._socket.listen()
        self._socket.settimeout(POLL_SECONDS)
        modules = ["harness.plugins.iktest.worker"]
        self._server = WarmServer(
            [*modules, "harness.plugins.iktest.builtin_ik"] if ":" not in name else modules
        )
        self._connection: Connection | None = None
        try:
            self.words = self._start()
        except BaseException:
            self.close()
            raise

    def __call__(self, arguments: Mapping[str, Value]) -> CallOutcome:
        """Call the function in its process."""
        if self._connection is None:
            self._start()
        assert self._connection is not None
        try:
            self._connection.send(dict(arguments))
            if self._connection.poll(WAITING_LIMIT * self._patience):
                return self._connection.recv()
        except (EOFError, OSError):
            self._server.kill(self._job)  # what has closed its connection is as good as dead
            ended = self._end()
            if ended.code == -signal.SIGPROF:
                return _hung(self._patience, " of processor time")
            return CallOutcome("died", text=_last_words(ended))
        self._server.kill(self._job)
        self._end()
        return _hung(WAITING_LIMIT * self._patience)

    def close(self) -> None:
        """End the process and the server that it comes from."""
        if self._connection is not None:
            self._connection.close()
        self._server.close()
        self._socket.close()
        self._folder.cleanup()

    def _start(self) -> tuple[str, ...]:
        """A new process, ready to be called; the parameters of its function."""
        self._job = self._server.start(
            serve, *self._arguments, self._patience, self._socket.getsockname()
        )
        self._connection = self._accept()
        try:
            if not self._connection.poll(IMPORT_SECONDS):
                raise UnusableSolver(
                    f"'{self._arguments[0]}' was not imported within {IMPORT_SECONDS:g} s: "
                    "does its file do more than define functions?"
                )
            kind, content = self._connection.recv()
        except (EOFError, OSError):
            ended = self._end()
            raise UnusableSolver(
                f"the process ended while '{self._arguments[0]}' was imported: {_last_words(ended)}"
            ) from None
        if kind == "unusable":
            raise UnusableSolver(content)
        return content

    def _accept(self) -> Connection:
        while True:
            try:
                link, _ = self._socket.accept()
                return Connection(link.detach())
            except TimeoutError:
                for event in self._server.wait(0):
                    if isinstance(event, Ended):
                        raise UnusableSolver(_last_words(event)) from None

    def _end(self) -> Ended:
        """Wait for the end of the process."""
        if self._connection is not None:
            self._connection.close()
        self._connection = None
        while True:
            for event in self._server.wait(None):
                if isinstance(event, Ended):
                    return event


def _hung(seconds: float, of: str = "") -> CallOutcome:
    return CallOutcome("hung", seconds=seconds, text=f"no answer in {seconds:g} s{of}")


def _last_words(ended: Ended) -> str:
    """How a process ended, and where its code was."""
    if ended.traceback:
        return ended.traceback.strip().splitlines()[-1]
    if ended.code is not None and ended.code < 0:
        how = f"the process was killed by {signal.Signals(-ended.code).name}"
    else:
        how = f"the process ended with exit code {ended.code}"
    at = re.search(r'File "([^"]+)", line (\d+)', ended.log)
    return f"{how} at {Path(at[1]).name}:{at[2]}" if at else how
