"""One suite from the parts that several machines ran, without its scenario files."""

from __future__ import annotations

import heapq
import os
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from harness.core.activity import Activity, unobserved
from harness.plugins.campaigns.conditions import read_conditions
from harness.plugins.campaigns.shards import ShardRecord, read_shard_records
from harness.reporting.json_text import compact_json
from harness.reporting.result import CaseResult
from harness.suite.discovery import UsageError
from harness.suite.hooks import SuiteHooks
from harness.suite.plan import cases_of
from harness.suite.request import SuiteRequest
from harness.suite.stream import (
    FILE,
    Inputs,
    Stream,
    StreamEntry,
    checked_line,
    is_intact,
    lines_of,
    read_line,
)
from harness.suite.suite_run import SuiteRun


def merge_parts(
    folders: Sequence[Path], target: Path, activity: Activity = unobserved
) -> tuple[SuiteRun, ShardRecord]:
    """Merge report folders of `harness run --shard`.

    Args:
        folders: The report folders of the parts.
        target: The folder that gets the results of all parts as one `results.jsonl`.
        activity: Called with the number of results that are merged, and their number.

    Returns:
        The whole suite, counted as one run would count it, and the description of the first part.

    Raises:
        UsageError: A folder holds no part, the target is one, or the parts are not of one suite.
        HarnessError: The results cannot be written.
    """
    records = read_shard_records(folders)
    inputs = _checked_inputs([folder / FILE for folder in folders])
    for folder in folders:
        if folder.resolve() == target.resolve():
            raise UsageError(f"'{folder}' holds a part; write the whole into another --report-dir")
    first = records[0]
    cases = read_conditions(folders[0]).replace if first.conditions else None
    request = SuiteRequest(**vars(first.selection), hooks=SuiteHooks(cases=cases))
    plan = cases_of([(Path(each.file), each.header) for each in first.files], request)
    suite = SuiteRun(plan, request)
    stream = Stream(target, name=f".{FILE}.{os.getpid()}")
    suite.read_from(stream)
    parts = [
        _results_of(suite, folder, Path(record.root))
        for folder, record in zip(folders, records, strict=True)
    ]
    try:
        for listed in inputs:
            stream.append(checked_line(compact_json(listed)))
        for done, (index, result, line) in enumerate(heapq.merge(*parts, key=_index)):
            activity("merging", done, len(plan))
            suite.take(index, result, stream.append(line))
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


def _checked_inputs(paths: Sequence[Path]) -> list[Inputs]:
    """The files that the results of parts follow from.

    Raises:
        UsageError: A line of a stream is not as it was written, or two parts ran different files.
    """
    found: dict[str, Inputs] = {}
    seen: dict[str, tuple[str, Path]] = {}
    for path in (each for each in paths if each.is_file()):
        listed: dict[str, Inputs] = {}
        used: dict[str, str] = {}
        with path.open("rb") as file:
            for number, (_, line) in enumerate(lines_of(file), start=1):
                if not line.strip():
                    continue
                if not is_intact(line):
                    raise UsageError(
                        f"line {number} of '{path}' is not as it was written: its checksum does"
                        " not match; run this part again with --resume"
                    )
                if (entry := read_line(line, StreamEntry)) is not None:
                    used[entry.key] = entry.inputs
                elif (inputs := read_line(line, Inputs)) is not None:
                    listed[inputs.digest] = inputs
        for inputs in (listed[each] for each in dict.fromkeys(used.values()) if each in listed):
            found[inputs.digest] = inputs
            for name, digest in inputs.files.items():
                other, where = seen.setdefault(name, (digest, path))
                if other != digest:
                    place = f"'{path.parent}'"
                    both = f"{place} and '{where.parent}' are not parts of one suite: they"
                    one = f"the results in {place} are of different states of the project: they"
                    raise UsageError(
                        f"{one if where == path else both} followed from different contents of"
                        f" '{name}'; run one again with --resume"
                    )
    return list(found.values())


def _results_of(
    suite: SuiteRun, folder: Path, root: Path
) -> Iterator[tuple[int, CaseResult, bytes]]:
    """The results of a part with their lines; those with a report name where it is now.

    Parts are written nearly in the order of the cases. Merged in this order, few results wait for
    one before them, however many there are.
    """
    if not (folder / FILE).is_file():
        return
    with (folder / FILE).open("rb") as file:
        for _, line in lines_of(file):
            entry = read_line(line, StreamEntry)
            index = entry and suite.plan.index_of.get((entry.result.file, entry.result.case))
            if entry is None or index is None:
                continue
            if entry.result.report_dir and root != folder:
                line = replace(entry, result=_moved(entry.result, root, folder)).line
            yield index, entry.result, line


def _index(found: tuple[int, CaseResult, bytes]) -> int:
    return found[0]


def _lacking(
    suite: SuiteRun, folders: Sequence[Path], records: Sequence[ShardRecord]
) -> Iterator[str]:
    """A sentence for each part that was interrupted."""
    numbers = records[0].shard.numbers_of(suite.plan)
    lacking = Counter(each for index, each in enumerate(numbers) if index not in suite.results)
    for folder, record in zip(folders, records, strict=True):
        number = record.shard.number
        if lacking[number]:
            yield (
                f"part {record.shard} in '{folder}' lacks {lacking[number]} of"
                f" {numbers.count(number)} results; run it again with --resume"
            )


def _moved(result: CaseResult, root: Path, folder: Path) -> CaseResult:
    """A result whose report is where the part's folder is now."""

    def moved(path: str) -> str:
        return str(folder / Path(path).relative_to(root)) if path else ""

    try:
        return replace(result, report_dir=moved(result.report_dir), page=moved(result.page))
    except ValueError:  # the report was written elsewhere
        return result
