"""Which cases a command runs: files times their cases, each with a folder for its report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, NoReturn

from harness.suite.cases import CaseJob
from harness.suite.discovery import UsageError
from harness.suite.folders import report_folders
from harness.suite.header import Header, read_header
from harness.suite.selection import selects
from harness.suite.variation import Case, Variation


@dataclass(frozen=True)
class Wanted:
    """What a command asks for.

    Attributes:
        expression: Of `-k`; empty for all.
        cases: Patterns of case names; empty for all.
        overrides: Dotted path -> value as YAML; they count more than a case's own.
        seed: Instead of the files'.
        samples: Instead of the files', of those that have some.
        report_root: Where reports go; None writes none.
        keep: Whose reports are written: `all`, `failed`, or by default of samples the failed ones.
        page: Whether a report gets its page.
        bag: Whether it gets a rosbag2.
    """

    expression: str = ""
    cases: Sequence[str] = ()
    overrides: Mapping[str, str] = field(default_factory=dict[str, str])
    seed: int | None = None
    samples: int | None = None
    report_root: Path | None = None
    keep: str = ""
    page: bool = True
    bag: bool = False


@dataclass(frozen=True)
class PlannedCase:
    """A case that will be run.

    Attributes:
        job: How to run it.
        header: Of its file.
        case: Which one it is.
    """

    job: CaseJob
    header: Header
    case: Case

    @property
    def variation(self) -> Variation:
        """What its file says of its cases."""
        return self.header.variation

    @property
    def rate_key(self) -> tuple[str, str] | None:
        """What samples that share a success rate have in common; None of other cases."""
        return None if self.case.sample is None else (str(self.job.file), self.case.group)

    @property
    def values(self) -> Mapping[str, Any]:
        """What varies from case to case."""
        return self.case.values


def planned(files: Sequence[Path], wanted: Wanted) -> list[PlannedCase]:
    """Every case of the files that is asked for, in file order.

    Raises:
        UsageError: Nothing is selected, `-k` cannot be read, or there is nothing to sample.
        SpecError: There is nothing to sample in a file with mistakes.
    """
    root = wanted.report_root
    folders = [None] * len(files) if root is None else report_folders(files, root)
    found: list[PlannedCase] = []
    for file, folder in zip(files, folders, strict=True):
        header = read_header(file)
        for case in header.variation.cases(wanted.seed, wanted.samples):
            if _is_wanted(file, header, case, wanted):
                found.append(PlannedCase(_job(file, case, folder, wanted), header, case))
    if not found:
        asked = f"-k '{wanted.expression}'" if wanted.expression else "--case"
        if wanted.cases:
            asked = f"--case '{wanted.cases[0]}'"
        raise UsageError(f"{asked} selects none of {len(files)} scenarios{_names(files, wanted)}")
    if wanted.samples is not None and all(each.case.sample is None for each in found):
        _refuse_samples(files, wanted)
    return found


def _refuse_samples(files: Sequence[Path], wanted: Wanted) -> NoReturn:
    """Say that nothing is sampled; mistakes in a file, which may hide its samples, come first."""
    from harness.spec.load import load_scenario

    for file in files:
        load_scenario(file, wanted.overrides)
    raise UsageError(
        f"--samples {wanted.samples}: nothing is random here; say what is with `randomize:` in the"
        f" file, or `samples: {wanted.samples}` there for as many seeds"
    )


def _is_wanted(file: Path, header: Header, case: Case, wanted: Wanted) -> bool:
    if wanted.cases and not any(fnmatchcase(case.name, pattern) for pattern in wanted.cases):
        return False
    return not wanted.expression or selects(wanted.expression, file, header, case.name)


def _names(files: Sequence[Path], wanted: Wanted) -> str:
    """Which cases there are, where a name was asked for and missed."""
    if not wanted.cases:
        return ""
    names = [
        case.name
        for file in files
        for case in read_header(file).variation.cases(wanted.seed, wanted.samples)
        if case.name
    ]
    shown = ", ".join(names[:10]) + (", ..." if len(names) > 10 else "")
    return f"; cases: {shown}" if names else "; the file has one case, without a name"


def _job(file: Path, case: Case, folder: Path | None, wanted: Wanted) -> CaseJob:
    keep = wanted.keep or ("all" if case.sample is None else "failed")
    return CaseJob(
        file,
        {**case.overrides, **wanted.overrides},
        wanted.seed if case.sample is None else None,
        folder / case.name if folder is not None and case.name else folder,
        page=wanted.page,
        bag=wanted.bag,
        case=case.name,
        only_failed=keep == "failed",
        redraw=case.redraw,
        fixed=wanted.overrides,
    )
