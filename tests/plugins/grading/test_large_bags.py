"""What grading a recording takes grows with its messages, whatever they say."""

import cProfile
import pstats
import sqlite3
import struct
import tracemalloc
from itertools import chain

import numpy as np
import pytest

from harness.core.errors import SpecError
from harness.core.limits import BAG_NUMBERS, READING_MEMORY
from harness.plugins.grading.grade import grade_bag
from tests.plugins.grading.hand_made import JOINTS, SCENARIO, state
from tests.plugins.grading.recordings import STORE, stamped

RATE = 500.0  # [Hz]
STATES = "sensor_msgs/msg/JointState"
EXPECTED = (
    "  - clearance: {between: [robot, box], at_least: 1 cm}\n"
    "  - eventually: {joints: {positions: {joint1: 0.1}}}\n"
)
SCHEMA = """
CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT,
  offered_qos_profiles TEXT);
CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);
"""


def serialized(content, msgtype):
    """A message in CDR."""

    def built(msgtype, content):
        fields = {}
        for name, (kind, about) in STORE.fielddefs[msgtype][1]:
            value = content[name]
            fields[name] = built(about, value) if kind == 2 else value
            if isinstance(value, list) and name != "name":
                fields[name] = np.array(value, dtype=float)
        return STORE.types[msgtype](**fields)

    return bytes(STORE.serialize_cdr(built(msgtype, content), msgtype))


def joint_states(count, position):
    """Rows of joint states whose first joint is at `position(time)`."""
    numbers = np.arange(1.0, 1 + len(JOINTS))
    content = stamped(state(0.0), 0.0)
    content["position"] = numbers.tolist()
    template = bytearray(serialized(content, STATES))
    place = bytes(template).index(numbers.tobytes())
    for row in range(count):
        time = row / RATE
        nanoseconds = round((1000 + time) * 1e9)
        struct.pack_into("<II", template, 4, *divmod(nanoseconds, 10**9))
        struct.pack_into("<5d", template, place, position(row, time), 0.0, 0.0, 0.0, 0.0)
        yield 1, nanoseconds, bytes(template)


def other_messages(first, count):
    """Rows of a topic that is not judged."""
    data = struct.pack("<4sI2s", b"\x00\x01\x00\x00", 2, b"x\x00")
    return ((2, round((1000 + (first + row) / RATE) * 1e9), data) for row in range(count))


def bag_of(path, rows):
    """A recording in SQLite, written faster than a recorder does."""
    with sqlite3.connect(path) as database:
        database.executescript("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF;" + SCHEMA)
        for number, name, kind in (
            (1, "/joint_states", STATES), (2, "/chatter", "std_msgs/msg/String"),
        ):  # fmt: skip
            row = (number, name, kind, "cdr", "")
            database.execute("INSERT INTO topics VALUES (?, ?, ?, ?, ?)", row)
        insert = "INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)"
        database.executemany(insert, rows)
    database.close()
    return path


def one(_row, time):
    """A joint that swings slowly."""
    return 0.3 * np.sin(time)


def two(row, time):
    """Two publishers: a joint that swings, and zeros."""
    return one(row, time) if row % 2 else 0.0


KINDS = {
    "one publisher": lambda count: joint_states(count, one),
    "two publishers": lambda count: joint_states(count, two),
    "a topic that goes on": lambda count: chain(
        joint_states(count // 2, one), other_messages(count // 2, count // 2)
    ),
}


def scenario(folder):
    file = folder / "large.scenario.yaml"
    file.write_text(SCENARIO.replace("mass: 0.1", "static: true") + EXPECTED)
    return file


@pytest.mark.nightly
@pytest.mark.parametrize("kind", KINDS)
def test_calls_and_memory_are_linear_in_the_messages(kind, tmp_path):
    """Counted at a number of messages and its double; time depends on the machine."""
    file, few = scenario(tmp_path), 2000
    bags = [bag_of(tmp_path / f"{n}.db3", KINDS[kind](n)) for n in (few, 2 * few)]
    grade_bag(file, bags[0], allowed=["publishers"])  # imports and reads the robot
    calls, peaks = [], []
    for bag in bags:
        with cProfile.Profile() as profile:
            grade_bag(file, bag, allowed=["publishers"])
        calls.append(pstats.Stats(profile).total_calls)
        tracemalloc.start()
        grade_bag(file, bag, allowed=["publishers"])
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert calls[1] < 2.2 * calls[0], calls
    assert peaks[1] < 2.2 * peaks[0], peaks
    assert peaks[1] < 3000 * 2 * few, "bytes for each message"


@pytest.mark.nightly
def test_ten_million_messages_of_another_topic_take_no_memory(tmp_path):
    rows = chain(joint_states(10_000, one), other_messages(10_000, 10**7))
    bag = bag_of(tmp_path / "long.db3", rows)
    tracemalloc.start()
    found = grade_bag(scenario(tmp_path), bag)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert [row.verdict.status for row in found.rows] == ["passed", "passed"]
    assert found.run.signals.times[-1] < 10_000 / RATE
    assert peak < 100e6


@pytest.mark.nightly
def test_joint_states_are_refused_where_they_take_more_than_the_memory(tmp_path):
    """Ten million messages; what is read of them before that is bounded."""
    bag = bag_of(tmp_path / "long.db3", joint_states(10**7, one))
    tracemalloc.start()
    with pytest.raises(SpecError, match=f"holds more than {BAG_NUMBERS} numbers"):
        grade_bag(scenario(tmp_path), bag)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < READING_MEMORY
