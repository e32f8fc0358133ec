"""A run's folder: its record, signals, visuals and resolved scenario; whole, or not there."""

from __future__ import annotations

import json
import os
import shutil
import zipfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, get_type_hints

import numpy as np

from harness.core.errors import HarnessError
from harness.core.geometry import Rgba
from harness.core.printable import json_printable
from harness.recording.arrays import arrays_of, read_npz, signals_from, write_npz
from harness.recording.files import FolderFiles, checked, write_files
from harness.recording.plain import from_plain, to_plain
from harness.recording.run import MeshRecord, Outcome, Run, StepRecord, Verdict

FORMAT = "armharness-run/1"
RUN, SIGNALS, RESOLVED = "run.json", "signals.npz", "scenario.resolved.yaml"
VISUALS, PAGE = "visuals.npz", "report.html"
APART = ("seed", "steps", "findings", "versions", "signals", "resolved", "meshes", "files")
"""Fields of a run that have a place of their own in its folder."""


@dataclass(frozen=True)
class StoredRun:
    """What a run's folder holds.

    Attributes:
        wall_times: Seconds of each part; never judged.
    """

    run: Run
    verdicts: tuple[Verdict, ...]
    outcome: Outcome
    digest: str
    wall_times: Mapping[str, float]


def write_run(
    folder: Path,
    run: Run,
    verdicts: Sequence[Verdict],
    outcome: Outcome,
    digest: str,
    wall_times: Mapping[str, float],
    extra: Callable[[Path], tuple[str, ...]] | None = None,
) -> tuple[str, ...]:
    """Write a run's folder under a temporary name beside it, then put it in its place.

    Args:
        folder: Its final name; an older run there is replaced, anything else is not touched.
        run: What happened.
        verdicts: What that means.
        outcome: Of the case.
        digest: Of run and verdicts.
        wall_times: Seconds of each part.
        extra: Adds more files to the folder it is given, before anyone sees it; returns notes.

    Returns:
        The notes of `extra`.

    Raises:
        HarnessError: The disk is full, the place is not writable, or is no place for a run.
    """
    _refuse_foreign(folder)
    temporary: Path | None = None
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        temporary = _fresh_sibling(folder, "writing")
        arrays = arrays_of(run.signals)
        document = _document(run, verdicts, outcome, digest, wall_times, arrays)
        text = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False)
        (temporary / RUN).write_text(json_printable(text) + "\n", encoding="utf-8")
        (temporary / RESOLVED).write_text(run.resolved, encoding="utf-8", newline="")
        write_npz(temporary / SIGNALS, arrays)
        write_npz(temporary / VISUALS, _mesh_arrays(run))
        write_files(temporary, run.files)
        notes = extra(temporary) if extra is not None else ()
        _put_in_place(temporary, folder)
    except OSError as error:
        raise HarnessError(
            f"the report cannot be written to {folder}: {error.strerror or error};"
            " free some space there, or choose another place with --report-dir"
        ) from error
    finally:
        if temporary is not None:
            shutil.rmtree(temporary, ignore_errors=True)
    return notes


def read_run(folder: Path) -> StoredRun:
    """Read a run's folder back; nothing in it is executed.

    Raises:
        HarnessError: There is no run, it is of another version, or it is damaged.
    """
    if not (folder / RUN).is_file():
        raise HarnessError(f"{folder} is no run: it has no {RUN}")
    try:
        document: dict[str, Any] = json.loads((folder / RUN).read_text(encoding="utf-8"))
        if document.get("format") != FORMAT:
            raise HarnessError(
                f"{folder / RUN} has the format {document.get('format')!r};"
                f" this version reads {FORMAT!r}"
            )
        arrays = read_npz(folder / SIGNALS)
        if (folder / VISUALS).is_file():
            arrays |= read_npz(folder / VISUALS)
        stored = _stored(document, arrays, (folder / RESOLVED).read_bytes().decode("utf-8"))
        return replace(stored, run=replace(stored.run, files=_files(folder, stored.run)))
    except (OSError, zipfile.BadZipFile, ValueError, TypeError, KeyError, AttributeError) as error:
        raise HarnessError(f"{folder} holds a damaged run: {error!r}") from error


def _document(
    run: Run,
    verdicts: Sequence[Verdict],
    outcome: Outcome,
    digest: str,
    wall_times: Mapping[str, float],
    arrays: dict[str, np.ndarray[Any, Any]],
) -> dict[str, Any]:
    """The content of run.json; arrays of trajectories go into `arrays`."""
    first = ("scenario", "file", "case")
    rest = [entry.name for entry in fields(run) if entry.name not in (*first, *APART)]
    return {
        "format": FORMAT,
        **{name: getattr(run, name) for name in first},
        "outcome": outcome,
        "digest": digest,
        "seed": run.seed,
        "steps": [_step(step, index, arrays) for index, step in enumerate(run.steps)],
        "verdicts": to_plain(tuple(verdicts)),
        "findings": to_plain(run.findings),
        "versions": to_plain(run.versions),
        "wall_times": to_plain(wall_times),
        "clearance_cutoff": run.signals.clearance_cutoff,
        **{name: to_plain(getattr(run, name)) for name in rest},
        "meshes": [
            {name: to_plain(getattr(mesh, name)) for name in ("path", "scale", "rgba")}
            for mesh in run.meshes
        ],
    }


def _files(folder: Path, run: Run) -> FolderFiles:
    names = [checked(name) for capture in run.captures for name in capture.files.values()]
    for video in run.videos:
        names += [checked(name) for name in (video.file, video.frames) if name]
    return FolderFiles(folder, names)


def _mesh_arrays(run: Run) -> dict[str, np.ndarray[Any, Any]]:
    arrays: dict[str, np.ndarray[Any, Any]] = {}
    for index, mesh in enumerate(run.meshes):
        arrays[f"meshes/{index}/vertices"] = mesh.vertices.astype(np.float32)
        arrays[f"meshes/{index}/faces"] = mesh.faces.astype(np.int32)
    return arrays


def _meshes(plain: Sequence[Any], arrays: Mapping[str, Any]) -> tuple[MeshRecord, ...]:
    return tuple(
        MeshRecord(
            path=Path(mesh["path"]),
            scale=from_plain(mesh["scale"], tuple[float, float, float]),
            vertices=arrays[f"meshes/{index}/vertices"].astype(np.float64),
            faces=arrays[f"meshes/{index}/faces"].astype(np.int64),
            rgba=from_plain(mesh["rgba"], Rgba | None),
        )
        for index, mesh in enumerate(plain)
    )


def _step(step: StepRecord, index: int, arrays: dict[str, np.ndarray[Any, Any]]) -> dict[str, Any]:
    """A step in run.json: its summary is `step`; `sim_time` is how long it took [s]."""
    plain = to_plain(replace(step, trajectory=None))
    trajectory: dict[str, Any] = {}
    for key, value in (step.trajectory or {}).items():
        if isinstance(value, np.ndarray):
            name = f"trajectories/{index}/{key}"
            arrays[name] = value
            trajectory[key] = {"array": name}
        else:
            trajectory[key] = to_plain(value)
    summary = plain.pop("summary")
    head = {"id": plain.pop("id"), "step": summary, "status": plain.pop("status")}
    head |= {"error_code": plain.pop("error_code"), "sim_time": step.end_time - step.start_time}
    plain["trajectory"] = None if step.trajectory is None else trajectory
    return head | plain


def _stored(document: dict[str, Any], arrays: dict[str, Any], resolved: str) -> StoredRun:
    for step in document["steps"]:
        step["summary"] = step.pop("step")
    signals = signals_from(arrays, float(document["clearance_cutoff"]))
    hints = get_type_hints(Run)
    known = {
        name: from_plain(document[name], hints[name])
        for name in hints
        if name in document and name not in {"signals", "meshes"}
    }
    meshes = _meshes(document.get("meshes", ()), arrays)
    run = Run(**known, signals=signals, resolved=resolved, meshes=meshes)
    steps = tuple(replace(step, trajectory=_trajectory(step, arrays)) for step in run.steps)
    return StoredRun(
        run=replace(run, steps=steps),
        verdicts=from_plain(document["verdicts"], tuple[Verdict, ...]),
        outcome=from_plain(document["outcome"], Outcome),
        digest=from_plain(document["digest"], str),
        wall_times=from_plain(document["wall_times"], Mapping[str, float]),
    )


def _trajectory(step: StepRecord, arrays: dict[str, Any]) -> dict[str, Any] | None:
    if step.trajectory is None:
        return None
    return {
        key: arrays[value["array"]] if isinstance(value, dict) else value  # pyright: ignore[reportUnknownArgumentType]
        for key, value in step.trajectory.items()
    }


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
    """A new, hidden folder beside the final one, on the same file system."""
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
