"""One command in a process of its own, forked from this one, and what it must not leave."""

from __future__ import annotations

import json
import os
import random
import re
import resource
import shutil
import signal
import time
import zipfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

LONGEST = 120.0  # processor time of a command that counts as a hang [s]
LONGEST_WAIT = 3600.0  # wall time, for a command that waits without an end [s]
IDLE_WAIT = 900.0  # wall time without any work; 80 s are none at load 48 [s]
CODES = (0, 1, 2, 3, 130, 141)
LOCK = re.compile(r"armharness-\d+-domain-\d+\.lock")  # of a domain of ROS 2, kept for the next one
TRACEBACK = "Traceback (most recent call last)"


@dataclass
class Ended:
    """How a command ended.

    Attributes:
        code: The exit code, or minus the number of the signal that ended it.
        hang: Why it was ended; empty where it ended by itself.
    """

    code: int
    said: str
    seconds: float
    hang: str = ""


def workplace(master: Path, place: Path) -> Path:
    """A copy of the folder of all commands, with a folder of its own for temporary files."""
    shutil.copytree(master, place, symlinks=True)
    (place / ".tmp").mkdir(exist_ok=True)
    return place


def start(
    command: Sequence[str],
    place: Path,
    *,
    stdin: str = "",
    prepare: Callable[[], None] | None = None,
    environment: Mapping[str, str] | None = None,
    said: Path | None = None,
) -> int:
    """Start a command in a session of its own; its process.

    Args:
        prepare: Is called in the new process, at the last moment before the command.
        said: The file of what it prints; `.said` in the folder by default.
    """
    said = said or place / ".said"
    stream = said.with_name(f"{said.name}.stdin")
    stream.write_text(stdin)
    if pid := os.fork():
        return pid
    try:
        os.setsid()
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, signal.SIG_DFL)
        written = os.open(said, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        read = os.open(stream, os.O_RDONLY)
        os.dup2(read, 0)
        os.dup2(written, 1)
        os.dup2(written, 2)
        os.closerange(3, 64)
        os.environ["TMPDIR"] = str(place / ".tmp")
        os.environ.pop("PYTEST_CURRENT_TEST", None)
        os.environ.update(environment or {})
        run_forked(list(command), str(place), prepare)
    finally:
        os._exit(99)


def run_forked(words: list[str], cwd: str, prepare: Callable[[], None] | None) -> None:
    """Be the command, whose fork server is a fork, too."""
    import sys
    import tempfile

    from harness.cli.main import entry
    from harness.suite import warm
    from tests.commands import ForkedServer

    warm.WarmServer = ForkedServer
    tempfile.tempdir = None
    os.chdir(cwd)
    sys.argv[:] = ["harness", *words]
    if prepare is not None:
        prepare()
    entry()


def finish(pid: int, said: Path, *, act: Callable[[float], bool] | None = None) -> Ended:
    """Wait for the end of a command and of its session.

    Args:
        said: What it prints, or the folder in which that is `.said`.
        act: Is called with the seconds since the start, again and again, until it says False.
    """
    said = said / ".said" if said.is_dir() else said
    begin, ended = time.monotonic(), Ended(0, "", 0.0)
    used, since = -1.0, begin
    while True:
        found, status, _ = os.wait4(pid, os.WNOHANG)
        now = time.monotonic()
        if found:
            ended.code = os.waitstatus_to_exitcode(status)
            break
        if act is not None and not act(now - begin):
            act = None
        work = processor_time(pid)
        if abs(work - used) > 0.01:  # less where a process of it has ended
            used, since = work, now
        if work > LONGEST or now > begin + LONGEST_WAIT or now > since + IDLE_WAIT:
            ended.hang = f"it hangs after {work:.0f} s of processor time, {now - begin:.0f} s"
            os.killpg(pid, signal.SIGKILL)
        time.sleep(0.002)
    ended.seconds = time.monotonic() - begin
    ended.said = said.read_text(errors="replace") if said.exists() else ""
    return ended


def processor_time(session: int) -> float:
    """Processor time of all processes of a session [s]."""
    total = 0.0
    for pid in members(session):
        with suppress(OSError, ValueError, IndexError):
            words = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
            total += sum(map(int, words[11:15])) / os.sysconf("SC_CLK_TCK")
    return total


def members(session: int) -> list[int]:
    """The processes of a session that live, and those that they have started in others."""
    parents: dict[int, int] = {}
    found: set[int] = set()
    for each in filter(str.isdigit, os.listdir("/proc")):  # noqa: PTH208 - names are enough
        with suppress(OSError):
            words = Path(f"/proc/{each}/stat").read_text().rpartition(")")[2].split()
            if words[0] not in "ZX":
                parents[int(each)] = int(words[1])
                found |= {int(each)} if words[3] == str(session) else set()
    while more := {pid for pid, parent in parents.items() if parent in found} - found:
        found |= more
    return sorted(found)


def end_session(session: int) -> None:
    """End every process of a session."""
    for pid in members(session):
        with suppress(OSError):
            os.kill(pid, signal.SIGKILL)


def complaints(ended: Ended, *, codes: Sequence[int] = CODES) -> list[str]:
    """What is wrong with the end of a command."""
    found = [ended.hang] if ended.hang else []
    if not ended.hang and ended.code not in codes:
        found.append(f"exit code {ended.code}")
    if TRACEBACK in ended.said or "Fatal Python error" in ended.said:
        found.append("a traceback")
    if "Exception ignored" in ended.said:
        found.append("an ignored exception")
    return found


def leftovers(place: Path, session: int, *, grace: float = 20.0) -> list[str]:
    """Processes, temporary files and halves of files that a command left."""
    end = time.monotonic() + grace
    while (alive := members(session)) and time.monotonic() < end:
        time.sleep(0.01)
    found = [f"{len(alive)} processes live on"] if alive else []
    end_session(session)
    halves = [each for each in place.rglob(".*") if each.parent.name != ".tmp" and is_half(each)]
    found += [f"left: {each.relative_to(place)}" for each in halves]
    own = place / ".tmp"  # a command may replace it
    temporary = [each.name for each in own.iterdir()] if own.is_dir() else []
    found += [f"temporary: {name}" for name in temporary if not LOCK.fullmatch(name)]
    return found


def is_half(path: Path) -> bool:
    """Whether a name is that of a file that is being written."""
    return path.name not in (".tmp", ".said", ".said.stdin") and (
        ".writing." in path.name or ".old." in path.name or path.name.rpartition(".")[2].isdigit()
    )


def damaged(place: Path) -> list[str]:
    """Files under the names of whole ones that are none."""
    found: list[str] = []
    for path in sorted(place.rglob("*")):
        if path.is_file() and not path.is_symlink() and not path.name.startswith("."):
            try:
                look_at(path)
            except Exception as error:  # noqa: BLE001 - each reader has errors of its own
                found.append(f"{path.relative_to(place)} is no whole file: {error}"[:200])
    return found


def look_at(path: Path) -> None:
    """Read a file to its end.

    Raises:
        Exception: It is not whole.
    """
    match path.suffix:
        case ".json":
            json.loads(path.read_text())
        case ".xml" | ".urdf" | ".srdf":
            ElementTree.parse(path)
        case ".npz":
            assert zipfile.ZipFile(path).testzip() is None
        case ".html":
            assert path.read_text().rstrip().endswith("</html>"), "no end"
        case ".mcap":
            assert path.read_bytes().endswith(b"\x89MCAP0\r\n"), "no end"
        case ".png":
            assert b"IEND" in path.read_bytes()[-12:], "no end"
        case ".jpg":
            assert path.read_bytes().endswith(b"\xff\xd9"), "no end"
        case ".yaml" if path.name == "scenario.resolved.yaml":
            assert path.read_text().endswith("\n")
        case _:
            pass


def limit(kind: int, value: int) -> Callable[[], None]:
    """What sets a limit of a process."""

    def apply() -> None:
        resource.setrlimit(kind, (value, value))

    return apply


def subprocess_of(pid: int, rng: random.Random) -> int:
    """A process of a session other than its first, or that one where there is no other."""
    others = [each for each in members(pid) if each != pid]
    return rng.choice(others) if others else pid
