"""Sampled conditions as a file: the same samples for another version, robot or planner."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from harness.core.errors import HarnessError
from harness.recording.plain import from_plain, to_plain
from harness.reporting.result import CaseResult
from harness.suite.discovery import UsageError
from harness.suite.folders import place_of
from harness.suite.plan import PlannedCase
from harness.suite.variation import Case

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


class Conditions:
    """Conditions by the scenario file that they belong to."""

    def __init__(self, path: Path, conditions: Iterable[Condition]) -> None:
        """Sort conditions by their file.

        Args:
            path: The file that they are from, for messages.
            conditions: The conditions, in the order of the samples.
        """
        self.path = path
        self._by_file: dict[str, list[Condition]] = {}
        for each in conditions:
            self._by_file.setdefault(each.file, []).append(each)

    def check(self, files: Sequence[Path]) -> None:
        """See that every scenario file has conditions.

        Raises:
            UsageError: One has none.
        """
        for file in files:
            if not self._of(file, is_alone=len(files) == 1):
                known = ", ".join(list(self._by_file)[:5])
                raise UsageError(
                    f"--conditions '{self.path}' has none for '{file}'; it has some for: {known}"
                )

    def cases(self, file: Path, *, is_alone: bool) -> Iterator[Case]:
        """The cases of a scenario file.

        Args:
            file: The scenario file that is run.
            is_alone: Whether it is the only one; then conditions of one other file are its own.
        """
        return (each.case for each in self._of(file, is_alone=is_alone))

    def _of(self, file: Path, *, is_alone: bool) -> Sequence[Condition]:
        found = self._by_file.get(place_of(file).as_posix(), [])
        if not found and is_alone and len(self._by_file) == 1:
            [found] = self._by_file.values()
        return found


def conditions_of(
    plan: Sequence[PlannedCase], results: Mapping[int, CaseResult]
) -> Iterator[Condition]:
    """The conditions of the samples that were run, as they were drawn at last."""
    for index, planned in enumerate(plan):
        case = planned.case
        if case.sample is None or index not in results:
            continue
        draw = results[index].redraws
        if draw and case.redraw is not None:
            redrawn = replace(case.redraw, fixed={}).redrawn(draw)
            case = replace(case, overrides=redrawn.overrides, values=redrawn.values)
        file = place_of(planned.job.file).as_posix()
        yield Condition(file, case.name, case.group, case.sample or 0, case.overrides, case.values)


def write_conditions(path: Path, conditions: Iterable[Condition]) -> None:
    """Write conditions, one on each line.

    Raises:
        HarnessError: The file cannot be written.
    """
    part = path.with_name(f".{path.name}.writing")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with part.open("w", encoding="utf-8") as file:
            file.write(json.dumps({"format": FORMAT}) + "\n")
            for each in conditions:
                file.write(json.dumps(to_plain(each)) + "\n")
        part.replace(path)
    except OSError as error:
        raise HarnessError(f"'{path}' cannot be written: {error.strerror}") from error
    finally:
        part.unlink(missing_ok=True)


def read_conditions(path: Path) -> Conditions:
    """Read the conditions of a file, or of the report folder of an earlier run.

    Raises:
        UsageError: There is no such file, or it cannot be read.
    """
    path = path / FILE if path.is_dir() else path
    try:
        with path.open(encoding="utf-8") as file:
            first = json.loads(file.readline())
            if not isinstance(first, dict) or first.get("format") != FORMAT:
                raise UsageError(f"'{path}' is not of the format {FORMAT}")
            found = [from_plain(json.loads(line), Condition) for line in file]
    except FileNotFoundError:
        raise UsageError(
            f"there is no '{path}'; a suite with samples writes {FILE} into its report folder"
        ) from None
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        raise UsageError(f"'{path}' cannot be read: {error}") from None
    if not found:
        raise UsageError(f"'{path}' has no conditions")
    return Conditions(path, found)
