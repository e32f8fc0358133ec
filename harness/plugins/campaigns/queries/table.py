"""Selected runs as rows, and their export to CSV and Parquet; never all of them in memory."""

from __future__ import annotations

import csv
import sqlite3
from collections.abc import Iterator
from io import TextIOWrapper
from itertools import islice
from pathlib import Path
from typing import Any

from harness.core.extras import install_command
from harness.core.files import replaced, writing
from harness.plugins.campaigns.queries.filters import Query, parameter_paths, sql_of
from harness.suite.discovery import UsageError

COLUMNS = (
    *("file", "name", "outcome", "cause", "reason", "seed", "digest", "sim_time"),
    *("expectation", "margin", "unit", "share", "report"),
)
ROWS_TOGETHER = 10_000  # in memory
NUMBERS = ("seed", "sim_time", "margin", "share")


def columns(connection: sqlite3.Connection) -> list[str]:
    """Names of the columns: those of a run, then the parameters."""
    return [*COLUMNS, *parameter_paths(connection)]


def rows(
    connection: sqlite3.Connection,
    query: Query,
    limit: int | None = None,
    *,
    is_worst_first: bool = False,
) -> Iterator[tuple[Any, ...]]:
    """Selected runs in the order of their results, a value for each of `columns`.

    Args:
        limit: The largest number of runs; None yields all.
        is_worst_first: Whether failures come first, then the runs that are nearest to failing.
    """
    where, values = sql_of(query, connection)
    paths = parameter_paths(connection)
    names = ", ".join(f"runs.{name}" for name in COLUMNS)
    names += len(paths) * (
        ", (SELECT text FROM parameters p WHERE p.key = runs.key AND p.path = ?)"
    )
    order = "outcome = 'passed', share IS NULL, share, number" if is_worst_first else "number"
    text = f"SELECT {names} FROM runs WHERE {where} ORDER BY {order}"
    cursor = connection.execute(
        f"{text} LIMIT ?", [*paths, *values, -1 if limit is None else limit]
    )
    while some := cursor.fetchmany(ROWS_TOGETHER):
        yield from some


def count(connection: sqlite3.Connection, query: Query) -> int:
    """How many runs are selected."""
    where, values = sql_of(query, connection)
    return connection.execute(f"SELECT count(*) FROM runs WHERE {where}", values).fetchone()[0]


def left_out(connection: sqlite3.Connection) -> int:
    """How many results of the journal the suite does not count."""
    text = "SELECT count(*) FROM all_runs WHERE key IN (SELECT key FROM left_out)"
    return connection.execute(text).fetchone()[0]


def write_csv(connection: sqlite3.Connection, query: Query, file: Path) -> int:
    """Write the selected runs as CSV.

    Returns:
        How many runs were written.

    Raises:
        HarnessError: The file cannot be written.
    """
    with writing(file.parent), replaced(file) as part:
        stream = TextIOWrapper(part, encoding="utf-8", newline="", write_through=True)
        writer = csv.writer(stream)
        writer.writerow(columns(connection))
        writer.writerows(rows(connection, query))
        stream.detach()
    return count(connection, query)


def write_parquet(connection: sqlite3.Connection, query: Query, file: Path) -> int:
    """Write the selected runs as Parquet; parameters without a unit are numbers.

    Returns:
        How many runs were written.

    Raises:
        UsageError: pyarrow is not installed.
        HarnessError: The file cannot be written.
    """
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError:
        raise UsageError(f"--parquet needs pyarrow: {install_command('parquet')}") from None
    names, numbers = columns(connection), _numeric_columns(connection)
    schema = pa.schema([(name, pa.float64() if name in numbers else pa.string()) for name in names])
    found = rows(connection, query)
    with writing(file.parent), replaced(file) as part, pq.ParquetWriter(part, schema) as writer:
        while batch := list(islice(found, ROWS_TOGETHER)):
            arrays = [
                pa.array([_cell(row[i], name in numbers) for row in batch], schema.field(i).type)
                for i, name in enumerate(names)
            ]
            writer.write_table(pa.table(arrays, schema=schema))
    return count(connection, query)


def _numeric_columns(connection: sqlite3.Connection) -> set[str]:
    found = connection.execute(
        "SELECT path FROM parameters GROUP BY path HAVING min(unit IS NOT NULL AND unit = '') = 1"
    )
    return {*NUMBERS, *(row[0] for row in found)}


def _cell(value: Any, is_number: bool) -> Any:
    if value is None:
        return None
    return float(value) if is_number else str(value)
