"""Writing a run's folder: whole, or not there."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Generator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.errors import HarnessError
from harness.core.printable import json_printable
from harness.recording.arrays import arrays_of, write_npz
from harness.recording.consistency import TABLES
from harness.recording.drawings import MeshRecord
from harness.recording.files import disk_advice, write_files
from harness.recording.older_runs import FORMAT
from harness.recording.plain import to_plain
from harness.recording.run import Run
from harness.recording.step_record import StepRecord
from harness.recording.stored_run import (
    CHECKSUM,
    RESOLVED,
    RUN,
    SIGNALS,
    VISUALS,
    StoredRun,
    checksum,
)

APART = ("seed", "steps", "findings", "versions", "signals", "files")
"""Fields of a run that have a place of their own in its folder."""


def write_run(folder: Path, stored: StoredRun) -> None:
    """Write a run's folder, which then holds nothing else.

    Raises:
        HarnessError: The disk is full, the place is not writable, or is no place for a run.
    """
    with run_folder(folder, stored.run) as target:
        write_document(target, stored)


@contextmanager
def run_folder(folder: Path, run: Run) -> Generator[Path]:
    """A new folder next to a run's, which takes its place when the block ends without an error.

    The block writes the document, and other files. Meanwhile the signals are written.

    Args:
        folder: Its final name; an older run there is replaced, anything else is not touched.
        run: The run with its signals and trajectories.

    Raises:
        HarnessError: The disk is full, the place is not writable, or is no place for a run.
    """
    _refuse_foreign(folder)
    temporary = None
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        temporary = _fresh_sibling(folder, "writing")
        arrays = arrays_of(run.signals) | _trajectories(run)
        with ThreadPoolExecutor(1) as pool:  # compression runs next to Python
            compressed = pool.submit(write_npz, temporary / SIGNALS, arrays)
            yield temporary
            compressed.result()
        _put_in_place(temporary, folder)
    except OSError as error:
        raise HarnessError(
            f"the report cannot be written to {folder}: {error.strerror or error};"
            f" {disk_advice(error)}choose another place with --report-dir"
        ) from error
    finally:
        if temporary is not None:
            shutil.rmtree(temporary, ignore_errors=True)


def write_document(folder: Path, stored: StoredRun) -> None:
    """Write everything of a run but its signals into its folder."""
    document, drawings = _document(stored), stored.drawings
    document[CHECKSUM] = checksum(document, stored.resolved)
    text = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False)
    (folder / RUN).write_text(json_printable(text) + "\n", encoding="utf-8")
    (folder / RESOLVED).write_text(stored.resolved, encoding="utf-8", newline="")
    write_npz(folder / VISUALS, _mesh_arrays(drawings.meshes))
    for files in (stored.run.files, drawings.files):
        write_files(folder, files)


def _document(stored: StoredRun) -> dict[str, Any]:
    """The content of run.json."""
    run = stored.run
    first = ("scenario", "file", "case")
    rest = [entry.name for entry in fields(run) if entry.name not in (*first, *APART)]
    return {
        "format": FORMAT,
        **{name: getattr(run, name) for name in first},
        "outcome": stored.outcome,
        "digest": stored.digest,
        "seed": run.seed,
        "steps": [_step(step, index) for index, step in enumerate(run.steps)],
        "verdicts": to_plain(stored.verdicts),
        "findings": to_plain(run.findings),
        "versions": to_plain(run.versions),
        "wall_times": to_plain(stored.wall_times),
        "clearance_cutoff": run.signals.clearance_cutoff,
        **{name: to_plain(getattr(run, name)) for name in rest},
        "videos": to_plain(stored.drawings.videos),
        "meshes": [
            {name: to_plain(getattr(mesh, name)) for name in ("path", "scale", "rgba")}
            for mesh in stored.drawings.meshes
        ],
    }


def _mesh_arrays(meshes: Sequence[MeshRecord]) -> dict[str, np.ndarray[Any, Any]]:
    arrays: dict[str, np.ndarray[Any, Any]] = {}
    for index, mesh in enumerate(meshes):
        arrays[f"meshes/{index}/vertices"] = mesh.vertices.astype(np.float32)
        arrays[f"meshes/{index}/faces"] = mesh.faces.astype(np.int32)
    return arrays


def _trajectories(run: Run) -> dict[str, np.ndarray[Any, Any]]:
    return {
        name: getattr(step.trajectory, key)
        for index, step in enumerate(run.steps)
        if step.trajectory is not None
        for key, name in _tables(index).items()
    }


def _tables(index: int) -> dict[str, str]:
    """The names of the arrays of a step's trajectory."""
    return {key: f"trajectories/{index}/{key}" for key in TABLES}


def _step(step: StepRecord, index: int) -> dict[str, Any]:
    """A step in run.json: its summary is `step`; `sim_time` is how long it took [s]."""
    plain = to_plain(replace(step, trajectory=None))
    if step.trajectory is not None:
        plain["trajectory"] = {
            "joint_names": list(step.trajectory.joint_names),
            **{key: {"array": name} for key, name in _tables(index).items()},
        }
    summary = plain.pop("summary")
    head = {"id": plain.pop("id"), "step": summary, "status": plain.pop("status")}
    head |= {"error_code": plain.pop("error_code"), "sim_time": step.end_time - step.start_time}
    return head | plain


def _refuse_foreign(folder: Path) -> None:
    """Never replace what is not a run: a mistyped place must not cost anybody their files."""
    if not folder.exists():
        return
    if not folder.is_dir():
        raise HarnessError(f"{folder} is a file; choose another place with --report-dir")
    if any(folder.iterdir()) and not (folder / RUN).is_file():
        raise HarnessError(
            f"{folder} holds other files and no run, so it is not replaced;"
            " empty it, or choose another place with --report-dir"
        )


def _fresh_sibling(folder: Path, purpose: str) -> Path:
    """A new, hidden folder next to the final one, on the same file system."""
    number = 0
    while True:
        sibling = folder.parent / f".{folder.name}.{purpose}.{os.getpid()}.{number}"
        try:
            sibling.mkdir()
        except FileExistsError:
            number += 1
        else:
            return sibling


def _put_in_place(temporary: Path, folder: Path) -> None:
    """Swap a finished folder in; if that fails the older one stays."""
    if not folder.exists():
        temporary.rename(folder)
        return
    attic = _fresh_sibling(folder, "old")
    try:
        folder.rename(attic / folder.name)
        try:
            temporary.rename(folder)
        except OSError:
            (attic / folder.name).rename(folder)
            raise
    finally:
        shutil.rmtree(attic, ignore_errors=True)
