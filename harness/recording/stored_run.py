"""A run as its folder holds it, and whether anything was changed there."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from harness.core.errors import HarnessError, Problem, SpecError
from harness.recording.digest import digest as digest_of
from harness.recording.drawings import NO_DRAWINGS, Drawings
from harness.recording.run import Outcome, Run
from harness.recording.verdict import Verdict

RUN, SIGNALS, RESOLVED = "run.json", "signals.npz", "scenario.resolved.yaml"
CHECKSUM = "checksum"
VISUALS, PAGE = "visuals.npz", "report.html"


@dataclass(frozen=True)
class StoredRun:
    """What a run's folder holds.

    Attributes:
        digest: The digest as run.json states it.
        wall_times: Seconds of each part; never judged.
        resolved: Text of the resolved scenario; runs again to the same digest.
        is_edited: Whether run.json or the resolved scenario was changed after it was written.
    """

    run: Run
    verdicts: tuple[Verdict, ...]
    outcome: Outcome
    digest: str
    wall_times: Mapping[str, float]
    resolved: str = ""
    drawings: Drawings = NO_DRAWINGS
    is_edited: bool = False

    @cached_property
    def content_digest(self) -> str:
        """The digest of signals, trajectories and verdicts as they are in the folder."""
        return digest_of(self.run, self.verdicts)

    def changes(self) -> list[str]:
        """What was changed in the folder after the run was written; one sentence each."""
        changes: list[str] = []
        if self.content_digest != self.digest:
            changes.append(
                "signals, trajectories or verdicts were changed after the run was written:"
                f" their digest is {self.content_digest[:12]}, {RUN} states {self.digest[:12]}"
            )
        if self.is_edited:
            changes.append(
                f"{RUN} or {RESOLVED} was changed after the run was written: the checksum differs"
            )
        return changes


@contextmanager
def blames_changes(folder: Path, stored: StoredRun) -> Generator[None]:
    """Report an error in processing a run as damage where the run was changed after writing.

    An exception on a run that is as it was written is a defect of the program and passes through.

    Raises:
        SpecError: The run was changed, and cannot be processed because of that.
    """
    try:
        yield
    except (HarnessError, OSError):
        raise
    except Exception as error:
        changes = stored.changes()
        if not changes:
            raise
        raise damage(folder, f"{changes[0]}; it cannot be processed: {error!r}") from error


def damage(path: Path, reason: str, line: int = 0, column: int = 0) -> SpecError:
    """The error of a file of a run that is damaged."""
    return SpecError([Problem(str(path), line, column, f"damaged run: {reason}")])


def checksum(document: Mapping[str, Any], resolved: str) -> str:
    """SHA-256 over run.json, but for the checksum itself, and the resolved scenario, in hex."""
    content = {key: value for key, value in document.items() if key != CHECKSUM}
    text = json.dumps([content, resolved], sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()
