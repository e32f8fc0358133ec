"""A run's folder: its record, signals, visuals and resolved scenario; whole, or not there."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import MISSING, dataclass, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Any, cast, get_type_hints

import numpy as np

from harness.core.errors import HarnessError, Problem, SpecError
from harness.core.geometry import Rgba
from harness.core.printable import json_printable
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.recording.arrays import arrays_of, is_signal, signals_from, write_npz
from harness.recording.consistency import (
    TABLES,
    Inconsistency,
    mesh_flaws,
    mesh_header_flaws,
    run_flaws,
    signal_flaws,
)
from harness.recording.digest import digest as digest_of
from harness.recording.files import FolderFiles, checked, write_files
from harness.recording.npz_file import NpzError, NpzFile
from harness.recording.older_runs import FORMAT, KNOWN_FORMATS, in_present_words
from harness.recording.plain import PlainError, from_plain, to_plain
from harness.recording.robot_record import MeshRecord
from harness.recording.run import Outcome, Run
from harness.recording.signals import Signals
from harness.recording.step_record import StepRecord
from harness.recording.step_results import SavedResult
from harness.recording.verdict import Verdict

RUN, SIGNALS, RESOLVED = "run.json", "signals.npz", "scenario.resolved.yaml"
CHECKSUM = "checksum"
LONE_SURROGATE = "\\ud"
"""How JSON writes half of a character, which no file or terminal can hold."""
VISUALS, PAGE = "visuals.npz", "report.html"
APART = ("seed", "steps", "findings", "versions", "signals", "resolved", "meshes", "files")
"""Fields of a run that have a place of their own in its folder."""
NEEDED = tuple(
    entry.name
    for entry in fields(Run)
    if entry.default is MISSING and entry.default_factory is MISSING and entry.name != "signals"
)
"""Keys without which run.json holds no run."""
_NOTHING = np.zeros(0)
NO_SIGNALS = Signals(_NOTHING, _NOTHING, _NOTHING, _NOTHING, _NOTHING, _NOTHING, tcp_pose=_NOTHING)
"""Until the arrays are read."""
MOST_FLAWS = 20
"""Problems of a damaged run that are listed."""


@dataclass(frozen=True)
class StoredRun:
    """What a run's folder holds.

    Attributes:
        digest: The digest as run.json states it.
        wall_times: Seconds of each part; never judged.
        is_edited: Whether run.json or the resolved scenario was changed after it was written.
    """

    run: Run
    verdicts: tuple[Verdict, ...]
    outcome: Outcome
    digest: str
    wall_times: Mapping[str, float]
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


def write_run(folder: Path, stored: StoredRun, extra: Callable[[Path], None] | None = None) -> None:
    """Write a run's folder under a temporary name next to it, then put it in its place.

    Args:
        folder: Its final name; an older run there is replaced, anything else is not touched.
        stored: The judged run that is written.
        extra: Adds more files to the folder it is given, before anyone sees it.

    Raises:
        HarnessError: The disk is full, the place is not writable, or is no place for a run.
    """
    _refuse_foreign(folder)
    run, temporary = stored.run, None
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        temporary = _fresh_sibling(folder, "writing")
        arrays = arrays_of(run.signals)
        document = _document(stored, arrays)
        document[CHECKSUM] = _checksum(document, run.resolved)
        text = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False)
        (temporary / RUN).write_text(json_printable(text) + "\n", encoding="utf-8")
        (temporary / RESOLVED).write_text(run.resolved, encoding="utf-8", newline="")
        with ThreadPoolExecutor(1) as pool:  # compression runs next to Python
            compressed = pool.submit(write_npz, temporary / SIGNALS, arrays)
            write_npz(temporary / VISUALS, _mesh_arrays(run))
            write_files(temporary, run.files)
            if extra is not None:
                extra(temporary)
            compressed.result()
        _put_in_place(temporary, folder)
    except OSError as error:
        raise HarnessError(
            f"the report cannot be written to {folder}: {error.strerror or error};"
            " free some space there, or choose another place with --report-dir"
        ) from error
    finally:
        if temporary is not None:
            shutil.rmtree(temporary, ignore_errors=True)


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
    expected = _checksum(document, run.resolved)
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
        return path.read_bytes().decode("utf-8")


def _read_document(path: Path) -> dict[str, Any]:
    """The content of run.json, of this version."""
    text = _read_text(path)
    try:
        document: Any = json.loads(text)
        if LONE_SURROGATE in text.lower():
            json.dumps(document, ensure_ascii=False).encode()
    except json.JSONDecodeError as error:
        raise _damage(path, error.msg, error.lineno, error.colno) from error
    except (ValueError, RecursionError) as error:
        raise _damage(path, str(error)) from error
    if not isinstance(document, dict):
        raise _damage(path, "expected a mapping")
    content = cast("dict[str, Any]", document)
    if content.get("format") not in KNOWN_FORMATS:
        said = f"format: expected '{FORMAT}', found {content.get('format')!r}"
        raise SpecError([Problem(str(path), 0, 0, said)])
    return content


def _run(path: Path, document: dict[str, Any]) -> tuple[Run, list[Any]]:
    """The run without its arrays, and the trajectories of its steps as run.json has them."""
    hints = get_type_hints(Run)
    with _damaged(path):
        document = in_present_words(document)
        steps = _mappings(document, "steps")
        own: dict[str, Any] = {"trajectory": None, "result": {"parts": ()}}
        bare = [{**step, "summary": step.get("step"), **own} for step in steps]
        plain = {**document, "steps": bare}
        known = {
            name: from_plain(plain[name], hint, name)
            for name, hint in hints.items()
            if name in plain and name not in ("signals", "meshes")
        }
        for name in NEEDED:
            _needed(known, name)
        known["steps"] = tuple(
            replace(record, result=_result(record.verb, step, f"steps[{index}]."))
            for index, (record, step) in enumerate(zip(known["steps"], steps, strict=True))
        )
        run = Run(**known, signals=NO_SIGNALS, meshes=_meshes(document))
    return run, [step.get("trajectory") for step in steps]


def _result(verb: str, step: Mapping[str, Any], within: str) -> SavedResult:
    saved = from_plain(step.get("result", {}), Mapping[str, Any], f"{within}result")
    return SavedResult(verb=verb, saved=saved)


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
        raise _damage(folder, f"{changes[0]}; it cannot be processed: {error!r}") from error


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
        raise _damage(path, "this file is missing") from error
    except UnicodeDecodeError as error:
        raise _damage(path, f"byte {error.start} is no UTF-8") from error
    except OSError as error:
        raise _damage(path, f"it cannot be read: {error.strerror or error}") from error


def _damage(path: Path, reason: str, line: int = 0, column: int = 0) -> SpecError:
    return SpecError([Problem(str(path), line, column, f"damaged run: {reason}")])


def _refuse(path: Path, flaws: Iterable[Inconsistency]) -> None:
    """Raise what is wrong, all of it at once."""
    problems = [
        Problem(str(path), 0, 0, ": ".join(filter(None, ["damaged run", key, reason])))
        for key, reason in flaws
    ]
    if problems:
        raise SpecError(problems[:MOST_FLAWS])


def _document(stored: StoredRun, arrays: dict[str, np.ndarray[Any, Any]]) -> dict[str, Any]:
    """The content of run.json; arrays of trajectories go into `arrays`."""
    run = stored.run
    first = ("scenario", "file", "case")
    rest = [entry.name for entry in fields(run) if entry.name not in (*first, *APART)]
    return {
        "format": FORMAT,
        **{name: getattr(run, name) for name in first},
        "outcome": stored.outcome,
        "digest": stored.digest,
        "seed": run.seed,
        "steps": [_step(step, index, arrays) for index, step in enumerate(run.steps)],
        "verdicts": to_plain(stored.verdicts),
        "findings": to_plain(run.findings),
        "versions": to_plain(run.versions),
        "wall_times": to_plain(stored.wall_times),
        "clearance_cutoff": run.signals.clearance_cutoff,
        **{name: to_plain(getattr(run, name)) for name in rest},
        "meshes": [
            {name: to_plain(getattr(mesh, name)) for name in ("path", "scale", "rgba")}
            for mesh in run.meshes
        ],
    }


def _checksum(document: Mapping[str, Any], resolved: str) -> str:
    """SHA-256 over run.json, but for the checksum itself, and the resolved scenario, in hex."""
    content = {key: value for key, value in document.items() if key != CHECKSUM}
    text = json.dumps([content, resolved], sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def _files(folder: Path, run: Run) -> FolderFiles:
    names = [name for capture in run.captures for name in capture.files.values()]
    names += [video.file for video in run.videos]
    try:
        return FolderFiles(folder, [checked(name) for name in names])
    except ValueError as error:
        raise PlainError("files", str(error)) from error


def _mesh_arrays(run: Run) -> dict[str, np.ndarray[Any, Any]]:
    arrays: dict[str, np.ndarray[Any, Any]] = {}
    for index, mesh in enumerate(run.meshes):
        arrays[f"meshes/{index}/vertices"] = mesh.vertices.astype(np.float32)
        arrays[f"meshes/{index}/faces"] = mesh.faces.astype(np.int32)
    return arrays


def _meshes(document: Mapping[str, Any]) -> tuple[MeshRecord, ...]:
    """The mesh files, without their triangles."""
    plain = _mappings(document, "meshes") if "meshes" in document else []
    return tuple(
        MeshRecord(
            path=_field(mesh, "path", Path, f"meshes[{index}]."),
            scale=_field(mesh, "scale", tuple[float, float, float], f"meshes[{index}]."),
            vertices=np.zeros((0, 3)),
            faces=np.zeros((0, 3), dtype=np.int64),
            rgba=_field(mesh, "rgba", Rgba | None, f"meshes[{index}]."),
        )
        for index, mesh in enumerate(plain)
    )


def _step(step: StepRecord, index: int, arrays: dict[str, np.ndarray[Any, Any]]) -> dict[str, Any]:
    """A step in run.json: its summary is `step`; `sim_time` is how long it took [s]."""
    plain = to_plain(replace(step, trajectory=None))
    if step.trajectory is not None:
        names = {name: f"trajectories/{index}/{name}" for name in TABLES}
        arrays |= {name: getattr(step.trajectory, key) for key, name in names.items()}
        plain["trajectory"] = {
            "joint_names": list(step.trajectory.joint_names),
            **{key: {"array": name} for key, name in names.items()},
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
