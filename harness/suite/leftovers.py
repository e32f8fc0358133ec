"""What processes that were killed while writing a report left in its folder."""

from __future__ import annotations

import glob
import os
import re
import shutil
import tempfile
from pathlib import Path

_TEMPORARY = re.compile(r"\.(?P<name>.+)\.(?P<kind>writing|old)\.(?P<pid>\d+)\.\d+")


def clean_leftovers(folder: Path) -> None:
    """Remove the temporary folders of processes that are gone next to one report's folder.

    `recording.write_run` writes under `.NAME.writing.PID.N` and keeps the older report in
    `.NAME.old.PID.N` while it swaps the two; an older report that lost its place is put back.
    """
    for sibling in sorted(folder.parent.glob(f".{glob.escape(folder.name)}.*")):
        match = _TEMPORARY.fullmatch(sibling.name)
        if match is None or match["name"] != folder.name or is_alive(int(match["pid"])):
            continue
        older = sibling / folder.name
        if match["kind"] == "old" and older.is_dir() and not folder.exists():
            older.rename(folder)
        shutil.rmtree(sibling, ignore_errors=True)


def remove_abandoned(prefix: str, parent: Path | None = None) -> None:
    """Remove temporary folders, named by a prefix and a process ID, of processes that are gone.

    Args:
        parent: The folder that they are in; that of temporary folders, if none is given.
    """
    for folder in (parent or Path(tempfile.gettempdir())).glob(f"{prefix}*"):
        pid = folder.name.removeprefix(prefix).partition("-")[0]
        if pid.isdigit() and not is_alive(int(pid)):
            shutil.rmtree(folder, ignore_errors=True)


def is_alive(pid: int) -> bool:
    """Whether a process of this machine runs.

    One that has ended does not, although its parent, as the first process of many containers,
    never waits for it.
    """
    try:
        os.kill(pid, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        return True
    try:
        status = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return True
    return status.rpartition(") ")[2][:1] != "Z"
