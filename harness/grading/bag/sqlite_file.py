"""Messages of a SQLite file in rosbag2's format."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

from harness.grading.bag.raw import LARGEST_RECORD, RawMessage, bag_error

MOST_TOPICS = 10_000


def sqlite_messages(file: Path, named: Path) -> Iterator[RawMessage]:
    """Every message of a SQLite file.

    Args:
        file: The file to read.
        named: The file in messages; it differs from `file` when that is an unpacked copy.

    Raises:
        SpecError: The file is empty, damaged, or not a SQLite recording.
    """
    if not file.stat().st_size:
        raise bag_error(named, "is empty")
    try:
        with closing(sqlite3.connect(f"{file.absolute().as_uri()}?mode=ro", uri=True)) as database:
            database.text_factory = _text
            database.execute("PRAGMA trusted_schema = OFF")
            database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST_RECORD)
            kinds = dict(database.execute("SELECT name, type FROM sqlite_master"))
            if any(kinds.get(name) != "table" for name in ("topics", "messages")):
                raise bag_error(
                    named, "is not a recording: it lacks the tables `topics` and `messages`"
                )
            topics = {
                number: (str(name), str(msgtype))
                for number, name, msgtype in database.execute(
                    "SELECT id, name, type FROM topics LIMIT ?", (MOST_TOPICS,)
                )
            }
            rows = database.execute("SELECT topic_id, timestamp, data FROM messages ORDER BY id")
            for number, time, data in rows:
                if number in topics and isinstance(data, bytes) and isinstance(time, int):
                    yield RawMessage(*topics[number], time, data)
    except (sqlite3.Error, MemoryError, OverflowError, UnicodeDecodeError) as error:
        hint = "`sqlite3 FILE .recover | sqlite3 WHOLE.db3` saves what is whole"
        said = str(error) or type(error).__name__
        raise bag_error(named, f"cannot be read as a database: {said}", hint) from error


def _text(data: bytes) -> str:
    """A text of the database, with damaged bytes replaced; names with such bytes match nothing."""
    return data.decode("utf-8", errors="replace")
