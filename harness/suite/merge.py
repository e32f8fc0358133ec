"""One suite from the parts that several machines ran, without its scenario files."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from harness.reporting.result import CaseResult
from harness.suite.conditions import read_conditions
from harness.suite.plan import SuiteRequest, cases_of
from harness.suite.shards import ShardRecord, read_shard_records
from harness.suite.stream import FILE, Stream, entry_of, head_of, lines_of
from harness.suite.suite_run import SuiteOptions, SuiteRun


def merge_parts(folders: Sequence[Path], target: Path) -> tuple[SuiteRun, ShardRecord]:
    """Merge report folders of `harness run --shard`.

    Args:
        folders: The report folders of the parts.
        target: The folder that gets the results of all parts as one `results.jsonl`.

    Returns:
        The whole suite, counted as one run would count it, and the description of the first part.

    Raises:
        UsageError: A folder holds no part, or the parts are not of one suite.
        HarnessError: The results cannot be written.
    """
    records = read_shard_records(folders)
    first = records[0]
    request = SuiteRequest(
        first.expression,
        first.cases,
        dict(first.overrides),
        first.seed,
        first.samples,
        conditions=read_conditions(folders[0]) if first.conditions else None,
    )
    plan = cases_of([(Path(each.file), each.header) for each in first.files], request)
    suite = SuiteRun(plan, SuiteOptions())
    stream = Stream(target, name=f".{FILE}.{os.getpid()}")
    suite.read_from(stream)
    places: dict[str, dict[str, int]] = {}
    for index, each in enumerate(plan):
        places.setdefault(str(each.file), {})[each.name] = index
    try:
        for folder, record in zip(folders, records, strict=True):
            _take_part(suite, stream, places, folder, Path(record.root))
        stream.rename()
    finally:
        target.joinpath(f".{FILE}.{os.getpid()}").unlink(missing_ok=True)
    suite.missing_parts = (
        *_lacking(suite, folders, records),
        *(
            f"part {number}/{first.shard.count} is missing"
            for number in range(1, first.shard.count + 1)
            if all(each.shard.number != number for each in records)
        ),
    )
    suite.count()
    return suite, first


def _take_part(
    suite: SuiteRun,
    stream: Stream,
    places: Mapping[str, Mapping[str, int]],
    folder: Path,
    root: Path,
) -> None:
    """Copy the results of a part; those with a report name where it is now."""
    if not (folder / FILE).is_file():
        return
    with (folder / FILE).open("rb") as file:
        for _, line in lines_of(file):
            head = head_of(line)
            index = None if head is None else places.get(head.result.file, {}).get(head.result.case)
            if head is None or index is None:
                continue
            if head.result.report_dir and root != folder and (entry := entry_of(line)):
                line = replace(entry, result=_moved(entry.result, root, folder)).line
            suite.take(index, head.result, stream.append(line))


def _lacking(
    suite: SuiteRun, folders: Sequence[Path], records: Sequence[ShardRecord]
) -> Iterator[str]:
    """A sentence for each part that was interrupted."""
    planned, lacking = Counter[int](), Counter[int]()
    for index, each in enumerate(suite.plan):
        number = records[0].shard.number_of(each.identity)
        planned[number] += 1
        lacking[number] += index not in suite.results
    for folder, record in zip(folders, records, strict=True):
        number = record.shard.number
        if lacking[number]:
            yield (
                f"part {record.shard} in '{folder}' lacks {lacking[number]} of {planned[number]}"
                " results; run it again with --resume"
            )


def _moved(result: CaseResult, root: Path, folder: Path) -> CaseResult:
    """A result whose report is where the part's folder is now."""

    def moved(path: str) -> str:
        return str(folder / Path(path).relative_to(root)) if path else ""

    try:
        return replace(result, report_dir=moved(result.report_dir), page=moved(result.page))
    except ValueError:  # the report was written elsewhere
        return result
