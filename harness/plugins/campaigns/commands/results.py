"""`harness results`."""

from __future__ import annotations

import argparse
import sqlite3
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from harness.cli.arguments import output_file, whole_number
from harness.cli.command import RESULTS, Command
from harness.cli.output import say, say_json
from harness.cli.shared_options import add_json
from harness.suite.outcome import EXIT_CODES

if TYPE_CHECKING:
    from harness.plugins.campaigns.queries.comparison import CampaignComparison
    from harness.plugins.campaigns.queries.filters import Query
    from harness.reporting.terminal import Style

SHOWN = 20  # runs that are printed unless `--limit` says otherwise


class ResultsCommand(Command):
    """Query, compare and export the results of many runs."""

    name: ClassVar[str] = "results"
    group: ClassVar[str] = RESULTS

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness results`."""
        add = command.add_argument
        add("folder", metavar="DIR", help="the report folder of a suite")
        outcomes = ("passed", "failed", "invalid", "error")
        add("--outcome", choices=outcomes, default="", help="select runs with this outcome")
        text = "select runs whose file has this tag; repeatable"
        add("--tag", metavar="TAG", dest="tags", action="append", default=[], help=text)
        text = "select failures whose cause contains this text"
        add("--cause", metavar="TEXT", default="", help=text)
        text = (
            "select runs in which this holds for a parameter, or for `margin`, `share`, `seed` or"
            " `sim_time`; repeatable: --where 'friction<0.4' --where 'margin<1 mm'"
        )
        add(
            "--where",
            metavar="NAME<VALUE",
            dest="conditions",
            action="append",
            default=[],
            help=text,
        )
        text = "print at most N runs (default: 20)"
        add("--limit", metavar="N", type=whole_number, default=None, help=text)
        text = (
            "compare with another campaign on the same conditions: exit code 1 when that one has a"
            " lower success rate"
        )
        add("--against", metavar="DIR", default="", help=text)
        text = "write the selected runs as CSV"
        add("--csv", metavar="FILE", type=output_file, default="", help=text)
        text = "write the selected runs as Parquet; needs the extra `parquet`"
        add("--parquet", metavar="FILE", type=output_file, default="", help=text)
        add_json(command)

    def run(self, arguments: argparse.Namespace) -> int:
        """Query, compare or export results; exit code 1 when the second campaign is worse."""
        from harness.plugins.campaigns.queries.database import open_campaign
        from harness.plugins.campaigns.queries.filters import Query

        query = Query(arguments.outcome, arguments.tags, arguments.cause, arguments.conditions)
        with open_campaign(Path(arguments.folder)) as database:
            if arguments.against:
                return _compare(arguments, database)
            if arguments.csv or arguments.parquet:
                return _export(arguments, database, query)
            if arguments.json:
                say_json(_document(arguments, database, query))
                return 0
            for line in _lines(arguments, database, query):
                say(line)
        return 0


def _export(arguments: argparse.Namespace, database: sqlite3.Connection, query: Query) -> int:
    from harness.plugins.campaigns.queries.table import write_csv, write_parquet

    for file, write in ((arguments.csv, write_csv), (arguments.parquet, write_parquet)):
        if file:
            say(f"{write(database, query, Path(file))} runs written to {file}")
    return 0


def _document(
    arguments: argparse.Namespace, database: sqlite3.Connection, query: Query
) -> dict[str, Any]:
    from harness.plugins.campaigns.queries.table import COLUMNS, columns, count, left_out, rows

    names = columns(database)
    found = rows(database, query, arguments.limit or SHOWN, is_worst_first=True)
    return {
        "format": "armharness-query/1",
        "selected": count(database, query),
        "left_out": left_out(database),
        "runs": [
            {
                name: value if name in COLUMNS else _plain(value)
                for name, value in zip(names, row, strict=True)
            }
            for row in found
        ],
    }


def _plain(value: str | None) -> float | str | None:
    """A parameter as a number where it has no unit."""
    from harness.core.quantity import split_quantity

    try:
        number, unit = split_quantity(value)
    except ValueError:
        return value
    return value if unit else number


def _lines(
    arguments: argparse.Namespace, database: sqlite3.Connection, query: Query
) -> Iterator[str]:
    """The count by outcome and cause, then the first runs that are selected."""
    from harness.plugins.campaigns.queries.filters import sql_of
    from harness.plugins.campaigns.queries.table import columns, left_out, rows
    from harness.reporting.terminal import Style

    style = Style.of(sys.stdout)
    where, values = sql_of(query, database)
    grouped = f"FROM runs WHERE {where} GROUP BY"
    outcomes = Counter[str](
        dict(database.execute(f"SELECT outcome, count(*) {grouped} outcome", values))
    )
    total = outcomes.total()
    counted = ", ".join(f"{number} {outcome}" for outcome, number in outcomes.most_common())
    yield style.strong(f"{total} runs{f': {counted}' if counted else ''}")
    causes = database.execute(
        f"SELECT cause, count(*) {grouped} cause HAVING cause IS NOT NULL ORDER BY 2 DESC LIMIT ?",
        [*values, SHOWN],
    )
    for cause, number in causes:
        yield f"  {number:>6}  {cause}"
    if not total:
        return
    if count := left_out(database):
        yield style.quiet(
            f"  {count} more left out, as the suite does: samples that its sequential test did not"
            " need, or cases that it no longer has"
        )
    yield ""
    names, limit = columns(database), arguments.limit or SHOWN
    for row in rows(database, query, limit, is_worst_first=True):
        yield _row(dict(zip(names, row, strict=True)), style)
    if total > limit:
        yield style.quiet(f"... {total - limit} more; --limit {total} prints all, --csv FILE too")


def _row(row: dict[str, Any], style: Style) -> str:
    from harness.plugins.campaigns.queries.table import COLUMNS
    from harness.reporting.sampled import short_value

    name = f"{row['file']} [{row['name']}]" if row["name"] else row["file"]
    drawn = ", ".join(
        f"{path} {short_value(value)}"
        for path, value in row.items()
        if path not in COLUMNS and value is not None
    )
    reason = row["cause"]
    if reason is None and row["margin"] is not None:
        unit = "" if row["unit"] == "1" else row["unit"]
        reason = f"margin {row['margin']:.4g} {unit}".rstrip()
    words = filter(None, (name, reason, drawn))
    return f"{style.mark(row['outcome'] == 'passed')} {'  '.join(words)}"


def _compare(arguments: argparse.Namespace, database: sqlite3.Connection) -> int:
    from harness.plugins.campaigns.queries.comparison import compare_campaigns
    from harness.plugins.campaigns.queries.database import DATABASE, open_campaign

    other = Path(arguments.against)
    with open_campaign(other):
        pass  # it is up to date now
    found = compare_campaigns(database, other / DATABASE)
    code = EXIT_CODES["failed" if found.is_worse else "passed"]
    if arguments.json:
        facts = {"exit_code": code, "is_worse": found.is_worse, "comparison": found}
        say_json({"format": "armharness-campaign-comparison/1", **facts})
        return code
    for line in _comparison_lines(arguments, found):
        say(line)
    return code


def _comparison_lines(arguments: argparse.Namespace, found: CampaignComparison) -> Iterator[str]:
    from harness.plugins.campaigns.queries.comparison import LEVEL

    pairs = found.pairs
    rates = [each / pairs for each in found.passed]
    yield f"{pairs} pairs of runs on the same conditions, {found.identical} with equal digests"
    if found.unpaired:
        yield f"  {found.unpaired} runs of either have no counterpart and do not count"
    yield (
        f"success rate {rates[0]:.2%} in '{arguments.folder}', {rates[1]:.2%} in"
        f" '{arguments.against}': {found.broken} broken, {found.repaired} repaired"
        f" (McNemar's test: p = {found.p_value:.3g})"
    )
    if found.p_value < LEVEL:
        yield "the success rates differ" + (": it is worse" if found.is_worse else ": it is better")
    else:
        yield (
            f"no difference is shown; a drop of {100 * found.detectable_drop:.2g} percentage points"
            " or more would have been detected with 80 % probability"
        )
    for name in found.broken_names:
        yield f"  broken: {name}"
    for each in found.margins:
        unit = "" if each.unit == "1" else each.unit
        yield (
            f"margin of '{each.expectation}': median change {each.median:+.3g} {unit}".rstrip()
            + f" over {each.pairs} pairs (Wilcoxon: p = {each.p_value:.3g})"
        )
