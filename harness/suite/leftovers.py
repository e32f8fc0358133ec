"""What processes that were killed while writing a report left beside it."""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path


def clean_leftovers(folder: Path) -> None:
    """Remove the temporary folders of dead processes beside a report folder.

    `recording.store` writes under `.NAME.writing.PID.N` and keeps the older report in
    `.NAME.old.PID.N` while it swaps the two; an older report that lost its place is put back.
    """
    pattern = re.compile(rf"\.{re.escape(folder.name)}\.(writing|old)\.(\d+)\.\d+")
    if not folder.parent.is_dir():
        return
    for sibling in sorted(folder.parent.iterdir()):
        match = pattern.fullmatch(sibling.name)
        if match is None or _is_alive(int(match[2])):
            continue
        older = sibling / folder.name
        if match[1] == "old" and older.is_dir() and not folder.exists():
            older.rename(folder)
        shutil.rmtree(sibling, ignore_errors=True)


def _is_alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        return True
    return True
