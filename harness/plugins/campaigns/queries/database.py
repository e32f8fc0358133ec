"""A SQLite view of a campaign's `results.jsonl`, brought up to date when it is opened."""

from __future__ import annotations

import math
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

from harness.core.errors import HarnessError
from harness.core.quantity import split_quantity
from harness.reporting.margins import margin_share, worst
from harness.reporting.suite.cause import cause_of
from harness.suite.discovery import UsageError
from harness.suite.stream import FILE, LeftOut, StreamEntry, lines_of, read_line

DATABASE = "results.sqlite"
VERSION = 4  # of the tables; a database of another one is made again
BATCH = 2000  # lines that are inserted together; this many are in memory

SCHEMA = """
CREATE TABLE all_runs (
  key TEXT PRIMARY KEY, number INTEGER, file TEXT, name TEXT, title TEXT, outcome TEXT, cause TEXT,
  reason TEXT, digest TEXT, seed INTEGER, sim_time REAL, report TEXT, page TEXT,
  expectation TEXT, margin REAL, unit TEXT, share REAL
);
CREATE TABLE left_out (key TEXT PRIMARY KEY) WITHOUT ROWID;
CREATE VIEW runs AS SELECT * FROM all_runs WHERE key NOT IN (SELECT key FROM left_out);
CREATE TABLE parameters (key TEXT, path TEXT, number REAL, unit TEXT, text TEXT,
  PRIMARY KEY (key, path)) WITHOUT ROWID;
CREATE TABLE tags (key TEXT, tag TEXT, PRIMARY KEY (key, tag)) WITHOUT ROWID;
CREATE TABLE verdicts (key TEXT, number INTEGER, line INTEGER, expectation TEXT, status TEXT,
  margin REAL, unit TEXT, PRIMARY KEY (key, number)) WITHOUT ROWID;
CREATE TABLE journal (bytes INTEGER, lines INTEGER, head TEXT);
CREATE INDEX runs_by_name ON all_runs (name, seed, file);
INSERT INTO journal VALUES (0, 0, '');
"""
HEAD_BYTES = 200  # of the journal, by which a replaced one is noticed


@contextmanager
def open_campaign(folder: Path) -> Iterator[sqlite3.Connection]:
    """The database of a report folder, with every result that its journal has by now.

    The view `runs` has those that the suite counts, the table `all_runs` the others too.

    Only lines that were added since the last time are read. A journal that was written anew is
    read from its beginning.

    Raises:
        UsageError: The folder has no results.
        HarnessError: The database cannot be written.
    """
    journal = folder / FILE
    if not journal.is_file():
        raise UsageError(
            f"'{folder}' has no {FILE}; `harness run` with several cases and `harness merge`"
            " write one"
        )
    try:
        with closing(_connected(folder / DATABASE)) as connection:
            _update(connection, journal)
            yield connection
    except (sqlite3.Error, OverflowError) as error:  # a number of more than 64 bits
        raise HarnessError(f"'{folder / DATABASE}': {error}") from error


def _connected(file: Path) -> sqlite3.Connection:
    """An open database of this version; one of another version, or broken, is made anew."""
    try:
        connection = sqlite3.connect(file)
        if connection.execute("PRAGMA user_version").fetchone()[0] == VERSION:
            return connection
        connection.close()
    except sqlite3.DatabaseError:
        pass
    file.unlink(missing_ok=True)
    connection = sqlite3.connect(file)
    connection.executescript(f"BEGIN; {SCHEMA} PRAGMA user_version = {VERSION}; COMMIT;")
    return connection


def _update(connection: sqlite3.Connection, journal: Path) -> None:
    start, count, head = connection.execute("SELECT * FROM journal").fetchone()
    with journal.open("rb") as file:
        first = file.read(HEAD_BYTES).hex()
        if journal.stat().st_size < start or first[: len(head)] != head:
            for table in ("all_runs", "left_out", "parameters", "tags", "verdicts"):
                connection.execute(f"DELETE FROM {table}")
            start = count = 0
        file.seek(start)
        batch: list[StreamEntry] = []
        for place, line in lines_of(file):
            start = place.offset + place.length
            entry = read_line(line, StreamEntry)
            if entry is not None:
                batch.append(entry)
            elif (left_out := read_line(line, LeftOut)) is not None:
                connection.execute("DELETE FROM left_out")
                rows = ((key,) for key in left_out.keys)
                connection.executemany("INSERT OR IGNORE INTO left_out VALUES (?)", rows)
            if len(batch) == BATCH:
                count = _insert(connection, batch, count)
        count = _insert(connection, batch, count)
    end = first[: 2 * min(start, HEAD_BYTES)]
    connection.execute("UPDATE journal SET bytes = ?, lines = ?, head = ?", (start, count, end))
    connection.commit()


def _insert(connection: sqlite3.Connection, batch: list[StreamEntry], count: int) -> int:
    """Insert results, the last one of equal keys; empties the batch."""
    entries = list({entry.key: entry for entry in batch}.values())
    keys = [(entry.key,) for entry in entries]
    for table in ("parameters", "tags", "verdicts"):
        connection.executemany(f"DELETE FROM {table} WHERE key = ?", keys)
    connection.executemany(
        f"INSERT OR REPLACE INTO all_runs VALUES ({', '.join('?' * 17)})",
        [_run(entry, count + index) for index, entry in enumerate(entries)],
    )
    connection.executemany(
        "INSERT INTO parameters VALUES (?, ?, ?, ?, ?)",
        [(e.key, path, *_value(value)) for e in entries for path, value in e.values.items()],
    )
    connection.executemany(
        "INSERT OR IGNORE INTO tags VALUES (?, ?)",
        [(e.key, tag) for e in entries for tag in e.tags],
    )
    connection.executemany(
        "INSERT INTO verdicts VALUES (?, ?, ?, ?, ?, ?, ?)",
        [
            (e.key, i, v.line, v.expectation, v.status, _finite(v.margin), v.unit)
            for e in entries
            for i, v in enumerate(e.result.verdicts)
        ],
    )
    batch.clear()
    return count + len(entries)


def _run(entry: StreamEntry, number: int) -> tuple[Any, ...]:
    result = entry.result
    cause, nearest = cause_of(result), worst(result.verdicts)
    return (
        entry.key,
        number,
        result.file,
        result.case,
        result.title,
        result.outcome,
        cause.group if cause else None,
        cause.text if cause else None,
        result.digest,
        result.seed,
        result.sim_time,
        result.report_dir or None,
        result.page or None,
        nearest.expectation if nearest else None,
        _finite(nearest.margin) if nearest else None,
        nearest.unit if nearest else None,
        margin_share(nearest) if nearest else None,
    )


def _value(value: Any) -> tuple[float | None, str | None, str]:
    """Number, unit and text of a value that varies."""
    try:
        number, unit = split_quantity(value)
    except ValueError:
        return None, None, str(value)
    return number, unit, str(value)


def _finite(number: float) -> float | None:
    return number if math.isfinite(number) else None
