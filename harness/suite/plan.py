"""Which cases a command runs: files times their cases, each with a folder for its report."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from functools import cached_property
from pathlib import Path
from typing import Any, NoReturn, Protocol

from harness.core.limits import CASE_PATTERN
from harness.core.options import values_of
from harness.core.variation import MOST_SAMPLES
from harness.session.run_request import RunOptions, RunRequest
from harness.suite.discovery import UsageError
from harness.suite.folders import folder_name, report_folders
from harness.suite.header import ScenarioHeader, read_header
from harness.suite.request import SuiteRequest
from harness.suite.selection import selects
from harness.suite.variation import Case


class FileCaseSequence(Protocol):
    """The cases of one file, each made when it is read."""

    def __len__(self) -> int: ...

    def __getitem__(self, index: int, /) -> Case: ...

    def name(self, index: int) -> str: ...

    def group(self, index: int) -> str | None:
        """The name of the parametrised case that a case is a sample of; None where it is none."""
        ...


@dataclass(frozen=True)
class FileCases:
    """The cases of one file.

    Attributes:
        file: The scenario file as the user names it.
        folder: The folder of its reports; None writes no reports.
    """

    file: Path
    header: ScenarioHeader
    folder: Path | None
    cases: FileCaseSequence
    request: SuiteRequest


@dataclass(frozen=True, slots=True)
class PlannedCase:
    """A case that will be run; its values are drawn when they are read.

    Attributes:
        of: The file of the case, with all its cases.
        position: The number of the case in its file, from 0.
    """

    of: FileCases
    position: int

    @property
    def file(self) -> Path:
        return self.of.file

    @property
    def header(self) -> ScenarioHeader:
        return self.of.header

    @property
    def name(self) -> str:
        return self.of.cases.name(self.position)

    @property
    def case(self) -> Case:
        return self.of.cases[self.position]

    @property
    def job(self) -> RunRequest:
        """How to run it."""
        return _job(self.of.file, self.case, self.of.folder, self.of.request)

    @property
    def rate_key(self) -> tuple[str, str] | None:
        """What samples that share a success rate have in common; None of other cases."""
        group = self.of.cases.group(self.position)
        return None if group is None else (str(self.of.file), group)

    @property
    def values(self) -> Mapping[str, Any]:
        fixed = self.header.variation.fixed
        return {path: fixed.get(path, value) for path, value in self.case.values.items()}


class Plan(list[PlannedCase]):
    """The cases of a suite in file order.

    Attributes:
        files: The files, each with all its cases.
    """

    def __init__(
        self, files: Sequence[FileCases], cases: Iterable[PlannedCase] | None = None
    ) -> None:
        """Remember which cases are selected; by default all of the files."""
        every = (PlannedCase(of, index) for of in files for index in range(len(of.cases)))
        super().__init__(every if cases is None else cases)
        self.files = files

    @cached_property
    def index_of(self) -> Mapping[tuple[str, str], int]:
        """The index of each case by its file, as the user named it, and its name."""
        return {(str(each.file), each.name): index for index, each in enumerate(self)}

    def where(self, is_selected: Iterable[bool]) -> Plan:
        """The cases of the plan that are selected, with one truth value for each."""
        return Plan(self.files, itertools.compress(self, is_selected))


def planned_cases(files: Sequence[Path], request: SuiteRequest) -> Plan:
    """Every case of the files that the request selects, in file order.

    Raises:
        UsageError: Nothing is selected, `-k` cannot be read, or there is nothing to sample.
        SpecError: There is nothing to sample in a file with mistakes.
    """
    found = cases_of([(file, read_header(file, request.overrides)) for file in files], request)
    if not found:
        option = f"-k '{request.expression}'" if request.expression else "--case"
        if request.cases:
            option = f"--case '{request.cases[0]}'"
        raise UsageError(f"{option} selects none of {len(files)} scenarios{_names(files, request)}")
    if request.samples is not None and all(each.rate_key is None for each in found):
        _refuse_samples(files, request)
    return found if request.hooks.part is None else request.hooks.part(found)


def cases_of(headers: Sequence[tuple[Path, ScenarioHeader]], request: SuiteRequest) -> Plan:
    """Every case that the request selects, of files whose headers are known, in file order.

    Raises:
        UsageError: `-k` cannot be read, or a file has too many cases.
    """
    if any(len(pattern) > CASE_PATTERN for pattern in request.cases):
        raise UsageError(f"--case: a pattern may have {CASE_PATTERN} characters at most")
    root = request.report_root
    files = [file for file, _ in headers]
    folders = [None] * len(files) if root is None else report_folders(files, root)
    found: list[FileCases] = []
    for (file, header), folder in zip(headers, folders, strict=True):
        if (count := header.variation.counted(request.samples)) > MOST_SAMPLES:
            raise UsageError(
                f"'{file}' has {count} cases; at most {MOST_SAMPLES} are run of a file"
            )
        cases = header.variation.cases(request.seed, request.samples)
        found.append(FileCases(file, header, folder, cases, request))
    plan = Plan(found if request.hooks.cases is None else request.hooks.cases(found))
    if not request.cases and not request.expression:
        return plan
    return plan.where(_is_selected(each, request) for each in plan)


def _refuse_samples(files: Sequence[Path], request: SuiteRequest) -> NoReturn:
    """Say that nothing is sampled; mistakes in a file, which may hide its samples, come first."""
    from harness.language.reading.load import load_scenario

    for file in files:
        load_scenario(file, request.overrides)
    raise UsageError(
        f"--samples {request.samples}: nothing is random here; say what is with `randomize:` in the"
        f" file, or `samples: {request.samples}` there for as many seeds"
    )


def _is_selected(planned: PlannedCase, request: SuiteRequest) -> bool:
    name, patterns = planned.name, request.cases
    if patterns and not any(fnmatchcase(name, pattern) for pattern in patterns):
        return False
    expression = request.expression
    return not expression or selects(expression, planned.file, planned.header, name)


def _names(files: Sequence[Path], request: SuiteRequest) -> str:
    """The existing case names, if `--case` selected none of them."""
    if not request.cases:
        return ""
    found = cases_of(
        [(file, read_header(file, request.overrides)) for file in files],
        replace(request, cases=(), expression=""),
    )
    names = list(itertools.islice((each.name for each in found if each.name), 11))
    shown = ", ".join(names[:10]) + (", ..." if len(names) > 10 else "")
    return f"; cases: {shown}" if names else "; the file has one case, without a name"


def _job(file: Path, case: Case, folder: Path | None, request: SuiteRequest) -> RunRequest:
    keep = request.keep or ("all" if case.sample is None else "failed")
    fixed = case.with_overrides(request.overrides)
    return RunRequest(
        file,
        fixed.overrides,
        request.seed if case.sample is None else None,
        folder / folder_name(case.name) if folder is not None and case.name else folder,
        page=request.page,
        bag=request.bag,
        case=case.name,
        only_failed=keep == "failed",
        redraw=fixed.redraw,
        live=request.hooks.live,
        options=request.options,
        **values_of(RunOptions, request),
    )
