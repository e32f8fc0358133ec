"""One suite from the parts that several machines ran, without its scenario files."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from harness.core.errors import HarnessError
from harness.reporting.result import CaseResult
from harness.suite.plan import SuiteRequest, cases_of
from harness.suite.shards import ShardRecord, read_shard_records
from harness.suite.stream import FILE, entry_of, read_results
from harness.suite.suite_run import SuiteOptions, SuiteRun

NO_REPORT = b'"report_dir": ""'
"""What a line of a journal has in it whose case has no report."""


def merge_parts(
    folders: Sequence[Path], target: Path | None = None
) -> tuple[SuiteRun, ShardRecord]:
    """Merge report folders of `harness run --shard`.

    Args:
        folders: The report folders of the parts.
        target: The folder that gets the results of all parts as one journal; None writes none.

    Returns:
        The whole suite, counted as one run would count it, and the description of the first part.

    Raises:
        UsageError: A folder holds no part, or the parts are not of one suite.
    """
    records = read_shard_records(folders)
    first = records[0]
    request = SuiteRequest(
        first.expression, first.cases, dict(first.overrides), first.seed, first.samples
    )
    plan = cases_of([(Path(each.file), each.header) for each in first.files], request)
    suite = SuiteRun(plan, SuiteOptions())
    places = {(str(each.job.file), each.case.name): index for index, each in enumerate(plan)}
    results: dict[int, CaseResult] = {}
    missing: list[str] = []
    for folder, record in zip(folders, records, strict=True):
        found = {
            places[result.file, result.case]: _moved(result, Path(record.root), folder)
            for _, result in read_results(folder / FILE)
            if (result.file, result.case) in places
        }
        results |= found
        planned = [i for i, each in enumerate(plan) if record.shard.holds(each.identity)]
        lacking = sum(index not in found for index in planned)
        if lacking:
            missing.append(
                f"part {record.shard} in '{folder}' lacks {lacking} of {len(planned)} results;"
                " run it again with --resume"
            )
    absent = sorted(set(range(1, first.shard.count + 1)) - {each.shard.number for each in records})
    missing += [f"part {number}/{first.shard.count} is missing" for number in absent]
    suite.take_all(results)
    suite.missing_parts = tuple(missing)
    if target is not None:
        _write_journal(folders, records, target)
    return suite, first


def _write_journal(folders: Sequence[Path], records: Sequence[ShardRecord], target: Path) -> None:
    """Write the results of all parts into one `results.jsonl`, for `harness results`.

    Raises:
        HarnessError: The file cannot be written.
    """
    part = target / f".{FILE}.{os.getpid()}"
    try:
        target.mkdir(parents=True, exist_ok=True)
        with part.open("wb") as merged:
            for folder, record in zip(folders, records, strict=True):
                root = Path(record.root)
                merged.writelines(_moved_lines(folder / FILE, root, folder))
        part.replace(target / FILE)
    except OSError as error:
        raise HarnessError(f"'{target / FILE}' cannot be written: {error.strerror}") from error
    finally:
        part.unlink(missing_ok=True)


def _moved_lines(journal: Path, root: Path, folder: Path) -> Iterator[bytes]:
    """The lines of a journal; those that name a report name where it is now."""
    if not journal.is_file():
        return
    with journal.open("rb") as file:
        for line in file:
            if NO_REPORT in line or root == folder:
                yield line
            elif (entry := entry_of(line)) is not None:
                yield replace(entry, result=_moved(entry.result, root, folder)).line.encode()


def _moved(result: CaseResult, root: Path, folder: Path) -> CaseResult:
    """A result whose report is where the part's folder is now."""

    def moved(path: str) -> str:
        return str(folder / Path(path).relative_to(root)) if path else ""

    try:
        return replace(result, report_dir=moved(result.report_dir), page=moved(result.page))
    except ValueError:  # the report was written elsewhere
        return result
