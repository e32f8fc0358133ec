"""Readers of recordings: bags, CSV files of joints, and folders of runs."""

from __future__ import annotations

import io
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from tests.campaigns import mutation
from tests.campaigns.mutation import Random
from tests.campaigns.reader import Read, Reader, after_its_name, put


@cache
def _tiny(folder: Path) -> Path:
    """A run, its bags and its scenario."""
    from tests.damaged.trials import tiny_run

    folder.mkdir(exist_ok=True)
    tiny_run(folder)
    return folder


def _bags(folder: Path) -> list[bytes]:
    tiny = _tiny(folder / "tiny")
    files = [
        next((tiny / kind).glob(f"*{end}"))
        for kind, end in (("mcap", ".mcap"), ("sqlite3", ".db3"))
    ]
    return [
        *(path.suffix.encode() + b":" + path.read_bytes() for path in files),
        b".bag:" + _ros1(folder),
    ]


def _ros1(folder: Path) -> bytes:
    from rosbags.rosbag1 import Writer

    from tests.plugins.grading.hand_made import JOINTS
    from tests.plugins.grading.test_ros1_bags import ROS1, joints

    path = folder / "old.bag"
    with Writer(path) as writer:
        kind = "sensor_msgs/msg/JointState"
        topic = writer.add_connection("/joint_states", kind, typestore=ROS1)
        for number in range(20):
            data = ROS1.serialize_ros1(joints(number / 10, list(JOINTS)), kind)
            writer.write(topic, 1_700_000_000 * 10**9 + number * 10**8, data)
    return path.read_bytes()


def _begin_bag(folder: Path) -> Read:
    from harness.plugins.grading.bag.content import BagTopics
    from harness.plugins.grading.bag.reader import read_bag

    del folder

    def read(folder: Path, data: bytes) -> None:
        suffix, _, content = data.partition(b":")
        read_bag(put(folder, f"changed{suffix.decode()}", content), BagTopics())

    return read


def _begin_grade(folder: Path) -> Read:
    from harness.plugins.grading.grade import grade_bag

    tiny = _tiny(folder / "tiny")

    def read(folder: Path, data: bytes) -> None:
        suffix, _, content = data.partition(b":")
        file = put(folder, f"changed{suffix.decode()}", content)
        grade_bag(tiny / "tiny.scenario.yaml", file)

    return read


def _tables(folder: Path) -> list[bytes]:
    del folder
    rows = "".join(f"{n / 10},{n / 50},0,0.1,-0.2\n" for n in range(30))
    names = "time,joint1,joint2,joint3,joint4\n"
    return [text.encode() for text in (names + rows, rows, (names + rows).replace(",", ";"))]


def _begin_table(folder: Path) -> Read:
    from harness.plugins.grading.bag.content import BagTopics
    from harness.plugins.grading.bag.joint_csv import read_joint_csv

    del folder
    names = [f"joint{n}" for n in range(1, 5)]

    def read(folder: Path, data: bytes) -> None:
        read_joint_csv(put(folder, "changed.csv", data), BagTopics(), names, [*names, "finger"])

    return read


RUN_FILES = ("run.json", "signals.npz", "visuals.npz", "scenario.resolved.yaml")


def _runs(folder: Path) -> list[bytes]:
    run = _tiny(folder / "tiny") / "run"
    return [name.encode() + b":" + (run / name).read_bytes() for name in RUN_FILES]


def _mutated_run(corpus: Sequence[bytes], rng: Random) -> bytes:
    import numpy as np

    from tests.damaged.mutants import damaged_arrays, npz_bytes

    name, _, content = rng.choice((corpus[0], corpus[0], *corpus)).partition(b":")
    if name.endswith(b".json"):
        changed = mutation.of_json([content], rng)
    elif name.endswith(b".npz") and rng.random() < 0.7:
        with np.load(io.BytesIO(content)) as file:
            arrays = dict(file)
        changed = npz_bytes(damaged_arrays(arrays, rng)) if arrays else content[:-1]
    elif name.endswith(b".npz"):
        changed = mutation.of_bytes([content], rng)
    else:
        changed = mutation.of_yaml([content], rng)
    return name + b":" + changed


def _begin_run(folder: Path) -> Read:
    import shutil

    from harness.recording.read_run import read_run

    whole = _tiny(folder / "tiny") / "run"
    run = folder / "run"
    shutil.copytree(whole, run, dirs_exist_ok=True)

    def read(_: Path, data: bytes) -> None:
        name, _, content = data.partition(b":")
        changed = put(run, name.decode(), content)
        try:
            stored = read_run(run)
            stored.changes()
        finally:
            shutil.copy(whole / changed.name, changed)

    return read


READERS: dict[str, Reader] = {
    "bag": Reader(_bags, after_its_name(mutation.of_bytes), _begin_bag, is_named=True),
    "grade": Reader(_bags, after_its_name(mutation.of_bytes), _begin_grade, is_named=True),
    "csv": Reader(_tables, mutation.of_text, _begin_table),
    "run": Reader(_runs, _mutated_run, _begin_run, is_named=True),
}
