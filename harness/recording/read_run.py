"""Reading a run's folder back; what is damaged is named by file and key."""

from __future__ import annotations

import json
from collections.abc import Generator, Iterable, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import MISSING, fields, replace
from pathlib import Path
from typing import Any, cast, get_type_hints

import numpy as np

from harness.core.errors import HarnessError, Problem, SpecError
from harness.core.files import read_at_most
from harness.core.limits import RUN_DOCUMENT
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.core.untrusted_json import parse_json
from harness.recording.arrays import is_signal, signals_from
from harness.recording.consistency import (
    TABLES,
    Inconsistency,
    mesh_flaws,
    mesh_header_flaws,
    run_flaws,
    signal_flaws,
    video_flaws,
)
from harness.recording.drawings import Drawings, MeshRecord
from harness.recording.files import FolderFiles, checked
from harness.recording.npz_file import NpzError, NpzFile
from harness.recording.older_runs import FORMAT, KNOWN_FORMATS, in_present_form
from harness.recording.plain import PlainError, from_plain
from harness.recording.run import Outcome, Run
from harness.recording.signals import VideoRecord
from harness.recording.step_record import StepRecord
from harness.recording.step_results import SavedDetails, SavedResult
from harness.recording.stored_run import (
    CHECKSUM,
    RESOLVED,
    RUN,
    SIGNALS,
    VISUALS,
    StoredRun,
    checksum,
    damage,
)
from harness.recording.verdict import Verdict

LONE_SURROGATE = "\\ud"  # How JSON writes half of a character, which no file or terminal can hold
NEEDED = tuple(
    entry.name
    for entry in fields(Run)
    if entry.default is MISSING and entry.default_factory is MISSING and entry.name != "signals"
)
"""Keys without which run.json holds no run."""
MOST_FLAWS = 20  # Problems of a damaged run that are listed


def read_run(folder: Path) -> StoredRun:
    """Read a run's folder back; nothing in it is executed, and nothing pickled is loaded.

    Raises:
        HarnessError: There is no run, or it is of another version.
        SpecError: It is damaged; names the file and the key.
    """
    if not (folder / RUN).is_file():
        raise HarnessError(f"{folder} is no run: it has no {RUN}")
    document = _read_document(folder / RUN)
    resolved = _read_text(folder / RESOLVED)
    expected = checksum(document, resolved)
    run = _run(folder, document)
    _refuse(folder / RUN, run_flaws(run))
    with _damaged(folder / RUN):
        return StoredRun(
            run=run,
            verdicts=_field(document, "verdicts", tuple[Verdict, ...]),
            outcome=_field(document, "outcome", Outcome),
            digest=_field(document, "digest", str),
            wall_times=_field(document, "wall_times", Mapping[str, float]),
            resolved=resolved,
            drawings=_drawings(folder, document, run),
            is_edited=document.get(CHECKSUM, expected) != expected,
        )


def _read_text(path: Path) -> str:
    with _damaged(path):
        return read_at_most(path, RUN_DOCUMENT).decode("utf-8")


def _read_document(path: Path) -> dict[str, Any]:
    """The content of run.json, of this version."""
    text = _read_text(path)
    try:
        document: Any = parse_json(text)
        if LONE_SURROGATE in text.lower():
            json.dumps(document, ensure_ascii=False).encode()
    except json.JSONDecodeError as error:
        raise damage(path, error.msg, error.lineno, error.colno) from error
    except (ValueError, RecursionError) as error:
        raise damage(path, str(error)) from error
    if not isinstance(document, dict):
        raise damage(path, "expected a mapping")
    content = cast("dict[str, Any]", document)
    if content.get("format") not in KNOWN_FORMATS:
        reason = f"format: expected '{FORMAT}', found {content.get('format')!r}"
        raise SpecError([Problem(str(path), 0, 0, reason)])
    return content


def _run(folder: Path, document: dict[str, Any]) -> Run:
    """The run with its arrays; what fits together in it is not yet checked."""
    hints = get_type_hints(Run)
    with _damaged(folder / RUN):
        document = in_present_form(document)
        steps = _mappings(document, "steps")
        empty = {"parts": ()}
        own = {"trajectory": None, "planner": empty, "explanation": empty, "result": empty}
        bare = [{**step, "summary": step.get("step"), **own} for step in steps]
        plain = {**document, "steps": bare}
        known = {
            name: from_plain(plain[name], hint, name)
            for name, hint in hints.items()
            if name in plain and name not in ("signals", "files")
        }
        for name in NEEDED:
            _needed(known, name)
        cutoff = _field(document, "clearance_cutoff", float)
        names = (name for each in known.get("captures", ()) for name in each.files.values())
        known["files"] = _files(folder, names)
    path = folder / SIGNALS
    with _damaged(path), NpzFile(path) as file:
        _refuse(path, signal_flaws(file.headers, known["robot"]))
        signals = signals_from(
            {name: file.read(name) for name in file.headers if is_signal(name)}, cutoff
        )
        known["steps"] = tuple(
            _step(record, step, f"steps[{index}]", file)
            for index, (record, step) in enumerate(zip(known["steps"], steps, strict=True))
        )
    return Run(**known, signals=signals)


def _step(record: StepRecord, step: Mapping[str, Any], key: str, file: NpzFile) -> StepRecord:
    """A step with its details, which stay as they were saved, and its trajectory."""
    planner, explanation, result = (
        from_plain(step.get(name, {}), Mapping[str, Any], f"{key}.{name}")
        for name in ("planner", "explanation", "result")
    )
    return replace(
        record,
        planner=SavedDetails(saved=planner),
        explanation=SavedDetails(saved=explanation),
        result=SavedResult(verb=record.verb, saved=result),
        trajectory=_trajectory(step.get("trajectory"), f"{key}.trajectory", file),
    )


def _mappings(document: Mapping[str, Any], name: str) -> list[dict[str, Any]]:
    """A list of mappings, as it is."""
    items = _needed(document, name)
    if not isinstance(items, list) or not all(isinstance(item, dict) for item in items):  # pyright: ignore[reportUnknownVariableType]
        raise PlainError(name, "expected a list of mappings")
    return cast("list[dict[str, Any]]", items)


def _needed(document: Mapping[str, Any], name: str, within: str = "") -> Any:
    if name not in document:
        raise PlainError(f"{within}{name}", "this key is missing")
    return document[name]


def _field(document: Mapping[str, Any], name: str, kind: Any, within: str = "") -> Any:
    return from_plain(_needed(document, name, within), kind, f"{within}{name}")


def _trajectory(plain: Any, key: str, file: NpzFile) -> JointTrajectory | None:
    if plain is None:
        return None
    content = from_plain(plain, Mapping[str, Any], key)
    return JointTrajectory(
        _field(content, "joint_names", tuple[str, ...], f"{key}."),
        **{name: _array(file, content, name, f"{key}.") for name in TABLES},
    )


def _array(file: NpzFile, content: Mapping[str, Any], key: str, within: str) -> FloatArray:
    """The array that run.json names."""
    name = _field(content, key, Mapping[str, str], within).get("array", "")
    if name not in file.headers:
        raise NpzError(name, f"this array is missing, though {RUN} names it as {within}{key}")
    return file.read(name)


def _drawings(folder: Path, document: Mapping[str, Any], run: Run) -> Drawings:
    """The videos, and the triangles of meshes; pictures of steps are files alone."""
    videos = from_plain(document.get("videos", ()), tuple[VideoRecord, ...], "videos")
    _refuse(folder / RUN, video_flaws(videos, run.cameras))
    meshes = from_plain(document.get("meshes", ()), tuple[MeshRecord, ...], "meshes")
    if meshes:
        meshes = _with_triangles(folder / VISUALS, meshes)
    return Drawings(meshes, videos, _files(folder, (video.file for video in videos)))


def _with_triangles(path: Path, meshes: Sequence[MeshRecord]) -> tuple[MeshRecord, ...]:
    with _damaged(path), NpzFile(path) as file:
        _refuse(path, mesh_header_flaws(file.headers, len(meshes)))
        whole = tuple(
            replace(
                mesh,
                vertices=file.read(f"meshes/{index}/vertices").astype(np.float64),
                faces=file.read(f"meshes/{index}/faces").astype(np.int64),
            )
            for index, mesh in enumerate(meshes)
        )
        _refuse(path, mesh_flaws(whole))
    return whole


@contextmanager
def _damaged(path: Path) -> Generator[None]:
    """What is wrong with a file of a run, as an error with its name and the key."""
    try:
        yield
    except PlainError as error:
        _refuse(path.with_name(RUN), [(error.key, error.expected)])
    except NpzError as error:
        _refuse(path, [(error.key, error.reason)])
    except FileNotFoundError as error:
        raise damage(path, "this file is missing") from error
    except UnicodeDecodeError as error:
        raise damage(path, f"byte {error.start} is no UTF-8") from error
    except OSError as error:
        raise damage(path, f"it cannot be read: {error.strerror or error}") from error


def _refuse(path: Path, flaws: Iterable[Inconsistency]) -> None:
    """Raise what is wrong, all of it at once."""
    problems = [
        Problem(str(path), 0, 0, ": ".join(filter(None, ["damaged run", key, reason])))
        for key, reason in flaws
    ]
    if problems:
        raise SpecError(problems[:MOST_FLAWS])


def _files(folder: Path, names: Iterable[str]) -> FolderFiles:
    try:
        return FolderFiles(folder, [checked(name) for name in names])
    except ValueError as error:
        raise PlainError("files", str(error)) from error
