"""A CSV of joint values over time, as courses hand them in, read as a recording."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path

from harness.core.errors import Problem, SpecError
from harness.core.limits import BAG_NUMBERS, CSV_FILE, READING_MEMORY
from harness.core.memory import limited_memory
from harness.language.files.yaml_file import read_text
from harness.plugins.grading.bag.content import BagContent, BagTopics, RecordedTrack
from harness.plugins.grading.bag.message_files import bag_error

TIMES = ("time", "t", "timestamp", "time_s", "seconds")
LATEST = 9e9
"""Latest time [s], so that nanoseconds fit into 64 bits."""


def read_joint_csv(
    path: Path, topics: BagTopics, arm_joints: Sequence[str], joints: Sequence[str]
) -> BagContent:
    """Read rows of joint positions [rad or m], one a time.

    With a line of names, columns are found by the names of joints, and `time` has the times [s].
    Without names a row has a time and the arm's joints, or the arm's joints alone, a period apart.

    Args:
        arm_joints: The joints of the arm, in the order of columns without names.
        joints: All joints of the robot.

    Raises:
        SpecError: It is no such table; the first line that is not is named.
    """
    text = read_text(path, kind="CSV of joint values", largest=CSV_FILE)
    try:
        with limited_memory(READING_MEMORY):
            return _read(text, path, topics, arm_joints, joints)
    except MemoryError:
        most = f"{READING_MEMORY / 1e9:g} GB"
        raise bag_error(path, f"takes more than {most} to read") from None


def _rows(text: str, path: Path) -> Iterator[tuple[int, list[str]]]:
    """The rows that have something, with the numbers of their lines."""
    separator = next((each for each in ",;\t" if each in text), ",")
    reader = csv.reader(text.splitlines(), delimiter=separator)
    try:
        for row in reader:
            if any(cell.strip() for cell in row):
                yield reader.line_num, row
    except csv.Error as error:
        raise SpecError([Problem(str(path), reader.line_num, 1, f"is no CSV: {error}")]) from error


def _read(
    text: str, path: Path, topics: BagTopics, arm_joints: Sequence[str], joints: Sequence[str]
) -> BagContent:
    rows = _rows(text, path)
    first = next(rows, None)
    if first is None:
        raise bag_error(path, "the file is empty")
    names = [cell.strip() for cell in first[1]]
    has_names = any(_number(cell) is None for cell in names if cell)
    if has_names:
        names = [_joint(name, topics) for name in names]
    else:
        rows = chain([first], rows)
        names = _names_of(len(names), path, arm_joints)
    time = next((i for i, name in enumerate(names) if name.lower() in TIMES), None)
    places = [i for i, name in enumerate(names) if name in joints]
    if not places or len({names[i] for i in places}) < len(places):
        hint = f"joints: {', '.join(joints)}; others: --joint-prefix PREFIX, --joint NAME=RECORDED"
        raise bag_error(path, "the first line names no joint of the robot once", hint)
    content, track = BagContent(), RecordedTrack(3 * len(places))
    for index, (line, row) in enumerate(rows):
        values = [_number(row[i]) if i < len(row) else None for i in places]
        second: float | None = index * topics.csv_period
        if time is not None:
            second = _number(row[time]) if time < len(row) else None
        if None in values or second is None or not 0 <= second < LATEST:
            message = f"{len(places)} joint positions{' and a time' if time is not None else ''}"
            raise SpecError([Problem(str(path), line, 1, f"this line does not have {message}")])
        track.logged.append(round(second * 1e9))
        track.stamps.append(round(second * 1e9))
        unknown = [math.nan] * (2 * len(places))
        track.numbers.extend([*(value for value in values if value is not None), *unknown])
        if len(track.numbers) > BAG_NUMBERS:
            raise bag_error(path, f"holds more than {BAG_NUMBERS} numbers of joints")
    content.joints[tuple(names[i] for i in places)] = track
    content.topics[topics.joint_states] = ("sensor_msgs/msg/JointState", len(track.logged))
    if not has_names:
        content.notes.append(f"the columns have no names; they are read as {', '.join(names)}")
    return content


def _names_of(columns: int, path: Path, arm_joints: Sequence[str]) -> list[str]:
    """The names of columns that have none."""
    if columns == len(arm_joints):
        return list(arm_joints)
    if columns == len(arm_joints) + 1:
        return ["time", *arm_joints]
    count = len(arm_joints)
    hint = f"write a first line of names: time, {', '.join(arm_joints)}"
    message = f"has {columns} columns without names; the arm has {count} joints"
    raise bag_error(path, message, hint)


def _joint(name: str, topics: BagTopics) -> str:
    known = topics.joint_names
    return known[name] if name in known else name.removeprefix(topics.joint_prefix)


def _number(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None
