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
)
from harness.recording.files import FolderFiles, checked
from harness.recording.npz_file import NpzError, NpzFile
from harness.recording.older_runs import FORMAT, KNOWN_FORMATS, in_present_form
from harness.recording.plain import PlainError, from_plain
from harness.recording.run import Outcome, Run
from harness.recording.signals import Signals
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
_NOTHING = np.zeros(0)
NO_SIGNALS = Signals(_NOTHING, _NOTHING, _NOTHING, _NOTHING, _NOTHING, _NOTHING, tcp_pose=_NOTHING)
"""Until the arrays are read."""
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
    run, trajectories = _run(folder / RUN, document)
    run = replace(run, resolved=_read_text(folder / RESOLVED))
    run = _with_arrays(folder / SIGNALS, run, document, trajectories)
    _refuse(folder / RUN, run_flaws(run))
    if run.meshes:
        run = _with_meshes(folder / VISUALS, run)
    expected = checksum(document, run.resolved)
    with _damaged(folder / RUN):
        return StoredRun(
            run=replace(run, files=_files(folder, run)),
            verdicts=_field(document, "verdicts", tuple[Verdict, ...]),
            outcome=_field(document, "outcome", Outcome),
            digest=_field(document, "digest", str),
            wall_times=_field(document, "wall_times", Mapping[str, float]),
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


def _run(path: Path, document: dict[str, Any]) -> tuple[Run, list[Any]]:
    """The run without its arrays, and the trajectories of its steps as run.json has them."""
    hints = get_type_hints(Run)
    with _damaged(path):
        document = in_present_form(document)
        steps = _mappings(document, "steps")
        empty = {"parts": ()}
        own = {"trajectory": None, "planner": empty, "explanation": empty, "result": empty}
        bare = [{**step, "summary": step.get("step"), **own} for step in steps]
        plain = {**document, "steps": bare}
        known = {
            name: from_plain(plain[name], hint, name)
            for name, hint in hints.items()
            if name in plain and name != "signals"
        }
        for name in NEEDED:
            _needed(known, name)
        known["steps"] = tuple(
            replace(
                record,
                planner=SavedDetails(saved=_details(step, "planner", index)),
                explanation=SavedDetails(saved=_details(step, "explanation", index)),
                result=SavedResult(verb=record.verb, saved=_details(step, "result", index)),
            )
            for index, (record, step) in enumerate(zip(known["steps"], steps, strict=True))
        )
        run = Run(**known, signals=NO_SIGNALS)
    return run, [step.get("trajectory") for step in steps]


def _details(step: Mapping[str, Any], name: str, index: int) -> Mapping[str, Any]:
    return from_plain(step.get(name, {}), Mapping[str, Any], f"steps[{index}].{name}")


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


def _with_arrays(
    path: Path, run: Run, document: Mapping[str, Any], trajectories: Sequence[Any]
) -> Run:
    """The run with its signals and trajectories."""
    with _damaged(path.with_name(RUN)):
        cutoff = _field(document, "clearance_cutoff", float)
    with _damaged(path), NpzFile(path) as file:
        _refuse(path, signal_flaws(file.headers, run.robot))
        signals = signals_from(
            {name: file.read(name) for name in file.headers if is_signal(name)}, cutoff
        )
        steps = tuple(
            replace(step, trajectory=_trajectory(plain, f"steps[{index}].trajectory", file))
            for index, (step, plain) in enumerate(zip(run.steps, trajectories, strict=True))
        )
    return replace(run, signals=signals, steps=steps)


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


def _with_meshes(path: Path, run: Run) -> Run:
    """The run with the triangles of its meshes."""
    with _damaged(path), NpzFile(path) as file:
        _refuse(path, mesh_header_flaws(file.headers, len(run.meshes)))
        meshes = tuple(
            replace(
                mesh,
                vertices=file.read(f"meshes/{index}/vertices").astype(np.float64),
                faces=file.read(f"meshes/{index}/faces").astype(np.int64),
            )
            for index, mesh in enumerate(run.meshes)
        )
        _refuse(path, mesh_flaws(meshes))
    return replace(run, meshes=meshes)


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


def _files(folder: Path, run: Run) -> FolderFiles:
    names = [name for capture in run.captures for name in capture.files.values()]
    names += [video.file for video in run.videos]
    try:
        return FolderFiles(folder, [checked(name) for name in names])
    except ValueError as error:
        raise PlainError("files", str(error)) from error
