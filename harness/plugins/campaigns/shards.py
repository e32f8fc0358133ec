"""A part of a suite for one of several machines, and the description that a merge needs."""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from harness.core.errors import SpecError
from harness.core.files import read_at_most, replaced, writing
from harness.core.limits import RESULTS_DOCUMENT
from harness.core.options import values_of
from harness.core.untrusted_json import parse_json
from harness.recording.plain import from_plain, to_plain
from harness.suite.discovery import UsageError
from harness.suite.header import ScenarioHeader, read_header
from harness.suite.installation import Installation, installation
from harness.suite.plan import Plan
from harness.suite.request import SuiteRequest, SuiteSelection
from harness.suite.variation import ONE_CASE, Variation

FORMAT = "armharness-shard/5"
FILE = "shard.json"
AUTO = "auto"
SOURCES = (
    "HARNESS_SHARD (such as 3/10), SLURM_ARRAY_TASK_ID with SLURM_ARRAY_TASK_COUNT,"
    " CI_NODE_INDEX with CI_NODE_TOTAL (GitLab), or JOB_COMPLETION_INDEX (Kubernetes) with"
    " HARNESS_SHARDS"
)
"""Environment variables that `--shard auto` reads, in this order."""


@dataclass(frozen=True)
class Shard:
    """One of several parts of a suite.

    Attributes:
        number: Number of the part, from 1.
        count: The number of parts that the suite has.
    """

    number: int
    count: int

    def __str__(self) -> str:
        return f"{self.number}/{self.count}"

    def numbers_of(self, plan: Plan) -> list[int]:
        """The part of each case, by a hash: none has more than a quarter above its share."""
        names = [f"{each.file.as_posix()}\0{each.name}" for each in plan]
        codes = (each.encode(errors="surrogateescape") for each in names)
        hashes = [int.from_bytes(hashlib.blake2b(each, digest_size=8).digest()) for each in codes]
        counts, numbers = [0] * self.count, [0] * len(plan)
        for index in sorted(range(len(plan)), key=hashes.__getitem__):
            part = hashes[index] % self.count
            if counts[part] >= len(plan) // self.count * 5 // 4:
                part = counts.index(min(counts))
            counts[part] += 1
            numbers[index] = part + 1
        return numbers

    def part_of(self, plan: Plan) -> Plan:
        """The cases of this part."""
        return plan.where(each == self.number for each in self.numbers_of(plan))


def shard_of(text: str, environment: Mapping[str, str] = os.environ) -> Shard:
    """The part that `3/10` names, or with `auto` the part that a scheduler's variables name.

    Raises:
        UsageError: The text is no part, or `auto` finds no variables.
    """
    if text == AUTO:
        return _scheduled_shard(environment)
    match = re.fullmatch(r"(\d{1,6})/(\d{1,6})", text)
    if match is None or not 1 <= int(match[1]) <= int(match[2]):
        raise UsageError(
            f"--shard '{text}': write NUMBER/COUNT with NUMBER from 1 to COUNT, such as 3/10, or"
            f" {AUTO}"
        )
    return Shard(int(match[1]), int(match[2]))


def _scheduled_shard(environment: Mapping[str, str]) -> Shard:
    def integer(name: str, default: int | None = None) -> int:
        value = environment.get(name, "" if default is None else str(default))
        try:
            return int(value)
        except ValueError:
            what = f"is '{value}'" if value else "is not set"
            raise UsageError(f"--shard {AUTO}: {name} {what}; it must be a number") from None

    if "HARNESS_SHARD" in environment:
        return shard_of(environment["HARNESS_SHARD"], {})
    if "SLURM_ARRAY_TASK_ID" in environment:
        first = integer("SLURM_ARRAY_TASK_MIN", 0)
        place = (integer("SLURM_ARRAY_TASK_ID") - first) // integer("SLURM_ARRAY_TASK_STEP", 1)
        return _checked(place + 1, integer("SLURM_ARRAY_TASK_COUNT"))
    if "CI_NODE_INDEX" in environment:
        return _checked(integer("CI_NODE_INDEX"), integer("CI_NODE_TOTAL"))
    if "JOB_COMPLETION_INDEX" in environment:
        return _checked(integer("JOB_COMPLETION_INDEX") + 1, integer("HARNESS_SHARDS"))
    raise UsageError(f"--shard {AUTO} needs one of these environment variables: {SOURCES}")


def _checked(number: int, count: int) -> Shard:
    if not 1 <= number <= count:
        raise UsageError(f"--shard {AUTO}: the environment names part {number} of {count}")
    return Shard(number, count)


@dataclass(frozen=True)
class PlannedFile:
    """A scenario file of a suite.

    Attributes:
        file: The path as the user named it.
        verifies: Requirements that the file names.
        varied: The values in the file that its cases follow from.
    """

    file: str
    title: str
    tags: tuple[str, ...]
    verifies: tuple[str, ...]
    varied: Mapping[str, Any]

    @property
    def header(self) -> ScenarioHeader:
        """The header that was read from the file."""
        variation = stated_variation(self.varied)
        return ScenarioHeader(self.title, self.tags, 1, variation, self.verifies, self.varied)


@dataclass(frozen=True)
class ShardRecord:
    """What a part has to know of the whole suite so that parts can be merged without its files.

    Attributes:
        shard: The part of the suite that this describes.
        root: The part's report folder, as the paths in its results begin.
        files: Every scenario file of the suite, in order.
        selection: What selects the cases of the whole suite.
        conditions: Hash of the samples of `--conditions`; empty where the files draw them.
        installation: The program and the libraries that ran the part.
    """

    shard: Shard
    root: str
    files: tuple[PlannedFile, ...]
    selection: SuiteSelection
    conditions: str = ""
    installation: Installation = field(default_factory=installation)

    @property
    def suite(self) -> dict[str, Any]:
        """What all parts of one suite have in common."""
        plain: dict[str, Any] = to_plain(replace(self, root="", shard=Shard(1, self.shard.count)))
        return plain | plain.pop("selection")


def record_of(
    files: Sequence[Path], request: SuiteRequest, shard: Shard, root: Path, conditions: str
) -> ShardRecord:
    """What a part of a suite has to know of the whole suite."""
    planned = [
        PlannedFile(str(file), header.title, header.tags, header.verifies, header.varied)
        for file in files
        for header in [read_header(file, request.overrides)]
    ]
    selection = SuiteSelection(**values_of(SuiteSelection, request))
    return ShardRecord(shard, str(root), tuple(planned), selection, conditions)


def write_shard_record(record: ShardRecord) -> None:
    """Write the description of a part into its report folder.

    Raises:
        HarnessError: The file cannot be written.
    """
    root = Path(record.root)
    text = json.dumps({"format": FORMAT, **to_plain(record)}, indent=1)
    with writing(root), replaced(root / FILE) as file:
        file.write(f"{text}\n".encode())


def read_shard_records(folders: Sequence[Path]) -> list[ShardRecord]:
    """The descriptions of parts of one suite, in the order of the folders.

    Raises:
        UsageError: A folder holds no part, or the parts are not of the same suite, or one part
            stands in two folders.
    """
    records: list[ShardRecord] = []
    for folder in folders:
        record = _read(folder)
        for other, place in zip(records, folders, strict=False):
            _check_same_suite(record, folder, other, place)
        records.append(record)
    return records


def _read(folder: Path) -> ShardRecord:
    path = folder / FILE
    try:
        entry = parse_json(read_at_most(path, RESULTS_DOCUMENT))
        if entry.pop("format") != FORMAT:
            raise UsageError(f"'{path}' is not of the format {FORMAT}")
        record = from_plain(entry, ShardRecord)
        for each in record.files:
            stated_variation(each.varied)  # a merge needs it
    except FileNotFoundError:
        raise UsageError(
            f"'{folder}' holds no {FILE}; name report folders of `harness run ... --shard N/COUNT`"
        ) from None
    except SpecError as error:
        raise UsageError(f"'{path}' cannot be read: {error.problems[0].message}") from None
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        raise UsageError(f"'{path}' cannot be read: {error}") from None
    return record


def _check_same_suite(record: ShardRecord, folder: Path, other: ShardRecord, place: Path) -> None:
    here, there = record.suite, other.suite
    if here != there:
        what = next(name for name in here if here[name] != there[name])
        names = {
            "files": "the scenario files, their cases, titles or tags",
            "shard": "the number of parts",
            "conditions": "the samples of --conditions",
            "installation": "the program or its libraries:"
            f" {other.installation.difference(record.installation)}",
        }
        raise UsageError(
            f"'{folder}' and '{place}' are not parts of one suite: they differ in"
            f" {names.get(what, what)}"
        )
    if record.shard == other.shard:
        raise UsageError(
            f"'{folder}' and '{place}' both hold part {record.shard}; name one of them"
        )


def stated_variation(varied: Mapping[str, Any]) -> Variation:
    """The variation that the values of a header say.

    Raises:
        ValueError, SpecError: They have a mistake.
    """
    from harness.language.files.source import Place, Source, located
    from harness.language.reading.case_keys import read_case_keys

    if not varied:
        return ONE_CASE
    entries = located(dict(varied), Place(Source(""))).mapping()
    return Variation.of(read_case_keys(entries, []))
