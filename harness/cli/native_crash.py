"""A command in a process of its own, so that a crash of a native library is an error with a file.

MuJoCo, Coal, Qhull and OpenCV process geometry that files describe. Commands that run cases have a
process for each case already.
"""

from __future__ import annotations

import ctypes
import mmap
import os
import signal
import sys

from harness.core.inputs import note_inputs

CRASHES = (signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS, signal.SIGFPE, signal.SIGILL)
PASSED_ON = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
DEATH_SIGNAL = 1  # option of Linux' prctl: the signal that a process gets when its parent ends


def in_own_process() -> tuple[int, str] | None:
    """Go on in a new process.

    Returns:
        None in the new process, and where there can be none. In the first one, after its end: the
        exit code, and what to print where it crashed.
    """
    if sys.platform != "linux":
        return None
    last_input = mmap.mmap(-1, mmap.PAGESIZE)  # shared by both
    blocked = signal.pthread_sigmask(signal.SIG_BLOCK, {*PASSED_ON, signal.SIGCHLD})
    child = os.fork()
    if not child:
        signal.pthread_sigmask(signal.SIG_SETMASK, blocked)
        ctypes.CDLL(None).prctl(DEATH_SIGNAL, signal.SIGKILL, 0, 0, 0)
        note_inputs(lambda path: _write(last_input, path))
        return None
    number = _end_of(child)
    if number >= 0:
        return number, ""
    name = signal.Signals(-number).name
    if -number not in CRASHES:
        return 128 - number, f"the process was ended by {name}"
    path = last_input[:].rstrip(b"\0").decode("utf-8", errors="replace")
    where = f"; it read '{path}' last, which may be damaged" if path else ""
    return 3, f"a native library crashed ({name}){where}"


def _write(last_input: mmap.mmap, path: str) -> None:
    last_input[:] = path.encode("utf-8", errors="replace")[: len(last_input)].ljust(
        len(last_input), b"\0"
    )


def _end_of(child: int) -> int:
    """The exit code of a process, or minus the signal that ended it; signals are blocked here.

    Signals that were sent to this process alone are passed on; those of a terminal reach both.
    """
    while True:
        found = signal.sigwaitinfo({*PASSED_ON, signal.SIGCHLD})
        if found.si_signo != signal.SIGCHLD:
            if found.si_code <= 0:  # of a process, not of the kernel
                os.kill(child, found.si_signo)
            continue
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return os.waitstatus_to_exitcode(status)
