"""Sampled conditions as a file: the same samples for another version, robot or planner."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import weakref
from array import array
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, BinaryIO

from pydantic import ValidationError

from harness.core.files import is_dir, open_regular, path_exists, replaced, writing
from harness.core.limits import RESULTS_LINE
from harness.core.untrusted_json import parse_json
from harness.reporting.json_text import compact_json
from harness.reporting.suite.columns import Columns
from harness.reporting.suite.record import SuiteCase
from harness.reporting.suite.write import History, write_suite
from harness.suite.discovery import UsageError
from harness.suite.folders import place_of
from harness.suite.plan import FileCases, PlannedCase
from harness.suite.stream import lines_of, validator
from harness.suite.variation import Case, as_yaml

if TYPE_CHECKING:
    from harness.suite.suite_run import SuiteRun

FORMAT = "armharness-conditions/1"
FILE = "conditions.jsonl"


@dataclass(frozen=True)
class Condition:
    """The values of one sample.

    Attributes:
        file: The path of the scenario file in its project, without its suffix.
        name: The name of the case.
        group: The name of the parametrised case that it is a sample of.
        sample: The number of the sample, from 0.
        overrides: Dotted path -> value as YAML, the seed among them.
        values: What varies, path -> value.
    """

    file: str
    name: str
    group: str
    sample: int
    overrides: Mapping[str, str] = field(default_factory=dict[str, str])
    values: Mapping[str, Any] = field(default_factory=dict[str, Any])

    @property
    def case(self) -> Case:
        """The case that is run; it is not drawn again."""
        return Case(self.name, self.overrides, self.values, self.group, self.sample)


class FileConditions:
    """The conditions of one scenario file, each read from the file of conditions when needed."""

    def __init__(self, conditions: BinaryIO) -> None:
        """Have none yet; `conditions` is the open file."""
        self._file = conditions
        self._offsets, self._lengths = array("Q"), array("I")
        self._names: list[str] = []
        self._groups: list[str] = []

    def add(self, condition: Condition, offset: int, length: int) -> None:
        """Take the condition at a place of the file."""
        self._offsets.append(offset)
        self._lengths.append(length)
        self._names.append(condition.name)
        is_like_last = self._groups[-1:] == [condition.group]
        self._groups.append(self._groups[-1] if is_like_last else condition.group)

    def __len__(self) -> int:
        return len(self._names)

    def __getitem__(self, index: int) -> Case:
        line = os.pread(self._file.fileno(), self._lengths[index], self._offsets[index])
        return validator(Condition).validate_json(line).case

    def name(self, index: int) -> str:
        """The name of a case."""
        return self._names[index]

    def group(self, index: int) -> str:
        """The name of the parametrised case that a case is a sample of."""
        return self._groups[index]


class Conditions:
    """Conditions by the scenario file that they belong to."""

    def __init__(self, path: Path) -> None:
        """Read a file of conditions.

        Raises:
            OSError: It cannot be read.
            ValueError: A line has another shape.
            UsageError: The file has another format.
        """
        self.path = path
        self._by_file: dict[str, FileConditions] = {}
        hasher = hashlib.sha256()
        self._file = open_regular(path)
        weakref.finalize(self, self._file.close)
        first = parse_json(self._file.readline(RESULTS_LINE))
        if not isinstance(first, dict) or first.get("format") != FORMAT:
            raise UsageError(f"'{path}' is not of the format {FORMAT}")
        for number, (place, line) in enumerate(lines_of(self._file), 2):
            hasher.update(line)
            try:
                condition = validator(Condition).validate_json(line)
            except ValidationError as error:
                wrong = error.errors()[0]
                words = f"line {number}", ".".join(map(str, wrong["loc"])), wrong["msg"]
                raise ValueError(": ".join(filter(None, words))) from error
            of_file = self._by_file.setdefault(condition.file, FileConditions(self._file))
            of_file.add(condition, place.offset, place.length)
        if not self._by_file:
            raise UsageError(f"'{path}' has no conditions")
        self.digest = hasher.hexdigest()

    def check(self, files: Sequence[Path]) -> None:
        """See that every scenario file has conditions.

        Raises:
            UsageError: One has none.
        """
        for file in files:
            if not len(self.cases(file, is_alone=len(files) == 1)):
                known = ", ".join(list(self._by_file)[:5])
                raise UsageError(
                    f"--conditions '{self.path}' has none for '{file}'; it has some for: {known}"
                )

    def replace(self, files: Sequence[FileCases]) -> list[FileCases]:
        """These samples in place of those that the files draw; all of them count."""
        is_alone = len(files) == 1
        return [
            replace(
                each,
                header=replace(
                    each.header, variation=replace(each.header.variation, stop_early=False)
                ),
                cases=self.cases(each.file, is_alone=is_alone),
            )
            for each in files
        ]

    def cases(self, file: Path, *, is_alone: bool) -> FileConditions:
        """The cases of a scenario file.

        Args:
            is_alone: Whether it is the only one; then conditions of one other file are its own.
        """
        found = self._by_file.get(place_of(file).as_posix())
        if found is None and is_alone and len(self._by_file) == 1:
            [found] = self._by_file.values()
        return found or FileConditions(self._file)

    def copy(self, folder: Path) -> None:
        """Write the same file into a folder, for a merge of parts.

        Raises:
            HarnessError: It cannot be written.
        """
        if not path_exists(folder / FILE) or not (folder / FILE).samefile(self.path):
            with writing(folder), replaced(folder / FILE) as file:
                self._file.seek(0)
                shutil.copyfileobj(self._file, file)


class ConditionWriter:
    """Writes the conditions of samples as the results of a suite are read."""

    def __init__(self, file: IO[bytes]) -> None:
        """Write the first line."""
        self._file = file
        file.write(json.dumps({"format": FORMAT}).encode() + b"\n")

    def add(self, planned: PlannedCase, case: SuiteCase) -> None:
        """Write the condition of a sample, as it was drawn at last; nothing of another case."""
        if planned.rate_key is None:
            return
        _, group = planned.rate_key
        overrides = {**as_yaml(case.values), "seed": str(case.result.seed)}
        if case.result.outcome not in ("passed", "failed"):  # its seed is not known from the run
            overrides = planned.case.overrides
        name, place = planned.name, place_of(planned.file).as_posix()
        number = int(name.rpartition("sample")[2])
        condition = Condition(place, name, group, number, overrides, case.values)
        self._file.write(f"{compact_json(condition)}\n".encode())


def write_results(suite: SuiteRun, folder: Path, history: History) -> tuple[Path, Columns]:
    """Write page, JUnit XML, results, and the conditions of samples, reading the results once.

    A part of a suite has conditions only where they were given to it: those of all parts are
    written by the merge.

    Returns:
        The page, and what varies in the cases.

    Raises:
        HarnessError: A file cannot be written.
    """
    has_samples = any(each.rate_key is not None for each in suite.plan)
    if suite.is_part or not has_samples:
        return write_suite(folder, suite.record, suite.exit_code, history)
    indices = list(suite.results)
    with writing(folder), replaced(folder / FILE) as file:
        conditions = ConditionWriter(file)

        def add(number: int, case: SuiteCase) -> None:
            conditions.add(suite.plan[indices[number]], case)

        return write_suite(folder, suite.record, suite.exit_code, history, on_case=add)


def read_conditions(path: Path) -> Conditions:
    """Read the conditions of a file, or of the report folder of an earlier run.

    Raises:
        UsageError: There is no such file, or it cannot be read.
    """
    path = path / FILE if is_dir(path) else path
    try:
        return Conditions(path)
    except FileNotFoundError:
        raise UsageError(
            f"there is no '{path}'; a suite with samples writes {FILE} into its report folder"
        ) from None
    except (OSError, ValueError, RecursionError) as error:
        raise UsageError(f"'{path}' cannot be read: {error}") from None
