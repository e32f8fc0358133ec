"""A value that another process computes while this one goes on."""

from __future__ import annotations

import os
import pickle
import select
import signal
import warnings
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection, Pipe
from pathlib import Path
from typing import Generic, NoReturn, TypeVar

from harness.core.activity import Activity
from harness.core.errors import HarnessError

T = TypeVar("T")


class Background(Generic[T]):
    """The value of a function, from a fork of this process.

    A process that has threads computes the value itself when it is needed. The function must not
    have other effects: an interruption leaves nothing half-written.
    """

    def __init__(self, function: Callable[[Activity], T], *, despite_threads: bool = False) -> None:
        """Begin to compute a value that can be pickled; the function reports its progress.

        Args:
            despite_threads: Whether such a process is forked too. A lock that another thread holds
                then stays locked in the fork, so the value may never come.
        """
        self._function: Callable[[Activity], T] | None = function
        self._pid = 0
        has_threads = len([*Path("/proc/self/task").iterdir()]) > 1  # native libraries' included
        if has_threads and not despite_threads:
            return
        self._reading, writing = Pipe(duplex=False)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # Python 3.12's, of threads
            self._pid = os.fork()
        if self._pid == 0:
            self._reading.close()  # so that writing fails once the parent is gone
            _compute(function, writing)
        writing.close()
        self._function = None  # so that this process does not keep what it refers to

    def has_message(self) -> bool:
        """Whether `result` would hear something at once."""
        return bool(self._pid) and self._reading.poll()

    def result(self, activity: Activity) -> T:
        """The value, as soon as it is known; its progress is reported until then.

        `close` alone waits for the process: giving a large memory back takes longer than many a
        value.

        Raises:
            HarnessError: The process ended without a value.
            Exception: What the function raised.
        """
        if self._function is not None:
            return self._function(activity)
        try:
            while (message := pickle.loads(self._reading.recv_bytes()))[0] == "progress":
                activity(*message[1])
        except EOFError:
            _, status = os.waitpid(self._pid, 0)
            self._pid = 0
            code = os.waitstatus_to_exitcode(status)
            raise HarnessError(f"the process in the background ended with code {code}") from None
        except BaseException:  # Ctrl-C
            self.close()
            raise
        if message[0] == "raised":
            raise message[1]
        return message[1]

    def close(self) -> None:
        """End the process, if it is still at work."""
        if self._pid:
            with suppress(ProcessLookupError):
                os.kill(self._pid, signal.SIGKILL)
            os.waitpid(self._pid, 0)
            self._pid = 0
            self._reading.close()


def _compute(function: Callable[[Activity], T], writing: Connection) -> NoReturn:
    """Send the function's value, and do nothing else that this process is to do."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C is reported by the parent

    def report(what: str, done: int = 0, total: int = 0) -> None:
        if select.select([], [writing], [], 0)[1]:  # it never waits for the parent
            writing.send_bytes(pickle.dumps(("progress", (what, done, total))))

    try:
        message = pickle.dumps(("value", function(report)))
    except BaseException as error:  # noqa: BLE001 - the parent raises it
        message = pickle.dumps(("raised", RuntimeError(repr(error))))
        with suppress(Exception):
            message = pickle.dumps(("raised", error))
    with suppress(OSError):  # the parent is gone
        writing.send_bytes(message)
    os._exit(0)
