"""Runs a student's program with bounded memory, processes, files and processor time.

Run as a script, it starts the command of its arguments, watches it with all that it starts, and
ends every one of them when it ends or exceeds a bound.
"""

from __future__ import annotations

import contextlib
import ctypes
import math
import os
import resource
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from harness.plugins.grading.assignment import Limits  # takes half a second

SUBREAPER, IS_SUBREAPER, DEATH_SIGNAL, NO_NEW_RIGHTS = 36, 37, 1, 38
"""Options of Linux' prctl."""

FIRST_USER = 61000
"""User of the first program where this process may change users; Debian gives such numbers to no
person and no service."""

MODULE = "harness.plugins.grading.classroom.confined"

LOOK_EVERY = 0.25  # [s]
SHARED = 8
"""Programs of one user, each with all its processes, that may run at the same time: the kernel
counts processes of a user, and the bound of one program is looked at every quarter of a second."""
EXCEEDED = 71
"""Exit code of a program that exceeded a bound."""


@dataclass(frozen=True)
class Confinement:
    """The bounds of a program.

    Attributes:
        folder: Its temporary folder, whose files are counted.
        inside: Its working folder, in `folder`.
        user: The user that it runs as; None keeps the user of this process.
    """

    folder: Path
    inside: Path
    limits: Limits
    user: int | None = None

    def command(self, words: Sequence[str]) -> list[str]:
        """A command that runs another one within the bounds."""
        bounds = self.limits
        numbers = [
            bounds.memory,
            bounds.processes,
            bounds.files,
            bounds.processor_time,
            -1 if self.user is None else self.user,
        ]
        places = [str(self.folder), str(self.inside)]
        return [sys.executable, "-m", MODULE, *places, *map(str, numbers), *words]

    def text(self, command: str) -> str:
        """The same of a command line in one text."""
        return shlex.join(self.command(shlex.split(command)))

    def own_folder(self) -> None:
        """Let the program's user write into its folder, and keep others out."""
        if self.user is None:
            return
        for path in (self.folder, *self.folder.rglob("*")):
            os.chown(path, self.user, self.user)
        self.folder.chmod(0o700)


def may_change_user() -> bool:
    """Whether programs can run as users of their own, who can read this installation."""
    if os.geteuid() != 0:
        return False
    try:
        done = subprocess.run(
            [sys.executable, "-c", f"import {MODULE}"],
            user=FIRST_USER,
            group=FIRST_USER,
            extra_groups=[],
            cwd="/",
            capture_output=True,
            check=False,
        )
    except OSError:  # an interpreter in a private folder
        return False
    return done.returncode == 0


def adopt_orphans() -> None:
    """Make processes whose parents end children of this one, so that `end_children` finds them."""
    _prctl(SUBREAPER, 1)


@contextlib.contextmanager
def adopted_orphans() -> Iterator[None]:
    """Adopt orphans for a time; then this process adopts what it did before."""
    before = ctypes.c_int(0)
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(IS_SUBREAPER, ctypes.byref(before), 0, 0, 0)
    adopt_orphans()
    try:
        yield
    finally:
        _prctl(SUBREAPER, before.value)


def _prctl(option: int, value: int) -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(option, value, 0, 0, 0)


class Process(NamedTuple):
    """A process of this machine, and what it uses.

    Attributes:
        memory: Its resident memory in bytes.
        seconds: Processor time, that of its children which have ended included [s].
    """

    parent: int
    threads: int
    memory: int
    seconds: float


def _processes() -> dict[int, Process]:
    """The processes of this machine."""
    found: dict[int, Process] = {}
    page, tick = resource.getpagesize(), 1.0 / os.sysconf("SC_CLK_TCK")
    for place in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError, ValueError, IndexError):
            words = (place / "stat").read_text(errors="replace").rpartition(")")[2].split()
            used = tick * sum(map(int, words[11:15]))
            found[int(place.name)] = Process(
                int(words[1]), int(words[17]), int(words[21]) * page, used
            )
    return found


def descendants(root: int, spared: Collection[int] = ()) -> dict[int, Process]:
    """What a process started, at any depth, without some of it and what that started."""
    every, found, waiting = _processes(), dict[int, Process](), {root}
    while waiting:
        waiting = {
            pid
            for pid, each in every.items()
            if each.parent in waiting and pid not in found and pid not in spared
        }
        found |= {pid: every[pid] for pid in waiting}
    return found


def children() -> set[int]:
    """The processes that this one is the parent of."""
    return {pid for pid, each in _processes().items() if each.parent == os.getpid()}


def end_children(spared: Collection[int] = ()) -> None:
    """Kill what this process started, but for some of it, until nothing else is left."""
    while left := descendants(os.getpid(), spared):
        for pid in left:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.kill(pid, signal.SIGKILL)
        for pid in left:
            with contextlib.suppress(ChildProcessError):
                os.waitpid(pid, os.WNOHANG)
        time.sleep(0.001)  # the orphans of those arrive


def _bound(memory: int, files: int, processes: int, seconds: float) -> None:
    """Bounds that the kernel keeps for each process."""
    os.umask(0o077)
    _prctl(DEATH_SIGNAL, signal.SIGKILL)
    _prctl(NO_NEW_RIGHTS, 1)
    for kind, most in (
        (resource.RLIMIT_AS, memory * 10**6),
        (resource.RLIMIT_FSIZE, files * 10**6),
        (resource.RLIMIT_CPU, math.ceil(seconds) + 1),  # whole seconds; `_excess` is exact
        (resource.RLIMIT_CORE, 0),
    ):
        resource.setrlimit(kind, (most, most))
    most = processes if os.geteuid() >= FIRST_USER else SHARED * processes + _threads_of_user()
    resource.setrlimit(resource.RLIMIT_NPROC, (most, most))  # the kernel exempts root


def _threads_of_user() -> int:
    """Processes and threads of the user that this process runs as."""
    running = _processes()
    with contextlib.suppress(OSError):
        return sum(
            each.threads
            for pid, each in running.items()
            if Path(f"/proc/{pid}").stat().st_uid == os.geteuid()
        )
    return len(running)


def main(words: Sequence[str]) -> int:
    """Run a command; its exit code, or `EXCEEDED` with a line that says what was exceeded."""
    folder, inside, command = words[0], words[1], words[7:]
    memory, processes, files, user = (int(words[index]) for index in (2, 3, 4, 6))
    seconds = float(words[5])
    adopt_orphans()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    places = {"HOME": folder, "TMPDIR": folder, "PATH": path}
    rights = {} if user < 0 else {"user": user, "group": user, "extra_groups": []}
    try:
        child = subprocess.Popen(
            command,
            cwd=inside,
            env={**os.environ, **places, "PYTHONDONTWRITEBYTECODE": "1"},
            process_group=0,  # all of a group end at once, while processes one by one may multiply
            preexec_fn=partial(_bound, memory, files, processes, seconds),
            **rights,
        )
    except OSError as error:
        sys.stderr.write(f"`{shlex.join(command)}` cannot be started: {error.strerror}\n")
        return 127
    signal.signal(signal.SIGINT, lambda *_: _to_group(child.pid, signal.SIGINT))
    reason = ""
    while not reason:
        with contextlib.suppress(subprocess.TimeoutExpired):
            child.wait(LOOK_EVERY)
            break
        reason = _excess(Path(folder), memory, processes, files, seconds)
    _to_group(child.pid, signal.SIGKILL)
    end_children()
    if reason:
        sys.stderr.write(f"ended by the grader: {reason}\n")
        return EXCEEDED
    return child.returncode if child.returncode >= 0 else 128 - child.returncode


def _to_group(group: int, number: signal.Signals) -> None:
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(group, number)


def _excess(folder: Path, memory: int, processes: int, files: int, seconds: float) -> str:
    """What all processes and files of the program exceed together; empty where nothing is."""
    running = descendants(os.getpid()).values()
    if (count := sum(each.threads for each in running)) > processes:
        return f"{count} processes and threads, {processes} may be"
    if (time_used := sum(each.seconds for each in running)) > seconds:
        return f"{time_used:.2f} s of processor time, {seconds:g} may be"
    if (used := sum(each.memory for each in running)) > memory * 10**6:
        return f"{used / 1e6:.0f} MB of memory, {memory} may be"
    size = 0
    for path in folder.rglob("*"):
        with contextlib.suppress(OSError):
            size += path.lstat().st_size
    return f"{size / 1e6:.0f} MB of files, {files} may be" if size > files * 10**6 else ""


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
