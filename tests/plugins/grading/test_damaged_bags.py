"""Files that are no recording, or are damaged: refused by their names, within bounds."""

import shutil
import sqlite3
import struct

import pytest
import zstandard
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag2 import StoragePlugin, Writer

from harness.cli.main import main
from harness.core.errors import SpecError
from harness.plugins.grading.bag import reader, storage
from harness.plugins.grading.grade import grade_bag
from tests.plugins.grading.recordings import (
    GAZEBO,
    POSES,
    SCENARIO,
    STORE,
)


@pytest.mark.parametrize("compression", list(CompressionType))
def test_chunks_may_be_compressed_in_any_way(recording, tmp_path, compression):
    path = recording.write(tmp_path / "packed.mcap", compression, chunk_size=20_000)
    assert reader.read_bag(path, GAZEBO).topics[POSES][1] == len(recording.of(POSES))


@pytest.mark.nightly
def test_qos_in_any_dialect_is_no_reason_to_refuse(recording, tmp_path):
    """Version 9 with words, as Kilted writes it, and then an unreadable version."""
    with Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        kinds = {m.topic: m.msgtype for m in recording.messages}
        topics = {
            topic: writer.add_connection(topic, kind, typestore=STORE)
            for topic, kind in kinds.items()
        }
        whole = recording.write(tmp_path / "whole.mcap")
        for raw in storage.messages(storage.bag_files(whole)):
            writer.write(topics[raw.topic], raw.log_time, raw.data)
    assert grade_bag(SCENARIO, tmp_path / "bag", GAZEBO).earned == 14
    database = sqlite3.connect(tmp_path / "bag/bag.db3")
    database.execute("UPDATE topics SET offered_qos_profiles = ': [ not yaml'")
    database.commit()
    database.close()
    assert grade_bag(SCENARIO, tmp_path / "bag", GAZEBO).earned == 14
    (tmp_path / "bag/metadata.yaml").unlink()
    grade = grade_bag(SCENARIO, tmp_path / "bag", GAZEBO)
    assert grade.earned == 14
    assert "metadata.yaml is missing, as after a recorder was killed" in grade.notes[0]


def empty(path, _):
    (path / "bag.mcap").write_bytes(b"")
    return path / "bag.mcap", "is empty"


def cut_off(path, whole):
    data = whole.read_bytes()
    (path / "bag.mcap").write_bytes(data[: len(data) * 2 // 3])
    return path / "bag.mcap", "is cut off after"


def no_mcap(path, _):
    (path / "bag.mcap").write_text("joint states of Monday\n" * 20)
    return path / "bag.mcap", "not an MCAP file"


def one_byte_changed(path, whole):
    data = bytearray(whole.read_bytes())
    data[len(data) // 2] ^= 0xFF
    (path / "bag.mcap").write_bytes(data)
    return path / "bag.mcap", "near byte"


def a_length_of_exabytes(path, whole):
    data = bytearray(whole.read_bytes())
    data[9:17] = struct.pack("<Q", 2**62)
    (path / "bag.mcap").write_bytes(data)
    return path / "bag.mcap", "exceeds limit"


def bomb(path, _):
    """A chunk of a hundred kilobytes that unpacks to gigabytes and says it were small."""
    packed = zstandard.ZstdCompressor(level=3, write_content_size=False)
    unpacked = packed.compressobj()
    data = b"".join(unpacked.compress(bytes(2**20)) for _ in range(600)) + unpacked.flush()
    body = struct.pack("<QQQI", 0, 0, 1000, 0) + struct.pack("<I", 4) + b"zstd"
    body += struct.pack("<Q", len(data)) + data
    record = b"\x06" + struct.pack("<Q", len(body)) + body
    with (path / "bag.mcap").open("wb") as file:
        writer = McapWriter(file)
        writer.start(profile="ros2")
        file.flush()
    start = (path / "bag.mcap").read_bytes()
    (path / "bag.mcap").write_bytes(start + record)
    return path / "bag.mcap", "unpacks to more than the maximum of 1000 bytes"


def nothing(path, _):
    return path / "nowhere", "there is no such recording"


def an_empty_folder(path, _):
    (path / "bag").mkdir()
    return path / "bag", "is not a recording: it has no metadata.yaml, no .mcap and no .db3 file"


def another_file(path, _):
    (path / "notes.txt").write_text("x")
    return path / "notes.txt", "is not a recording"


def broken_metadata(path, _):
    (path / "bag").mkdir()
    (path / "bag/metadata.yaml").write_text("rosbag2_bagfile_information:\n  version: [8\nx: }")
    return path / "bag", "metadata.yaml:3:"


def metadata_without_files(path, _):
    (path / "bag").mkdir()
    (path / "bag/metadata.yaml").write_text("- 1\n")
    return path / "bag", "does not list the recording's files"


def a_missing_file(path, whole):
    (path / "bag").mkdir()
    text = "rosbag2_bagfile_information: {relative_file_paths: [../../one.mcap]}"
    (path / "bag/metadata.yaml").write_text(text)
    shutil.copy(whole, path / "one.mcap")
    return path / "bag", "one.mcap: is missing, although metadata.yaml lists it"


def no_database(path, _):
    (path / "bag.db3").write_text("SQLite format 4\0" + "x" * 5000)
    return path / "bag.db3", "cannot be read as a database"


def another_database(path, _):
    database = sqlite3.connect(path / "bag.db3")
    database.execute("CREATE VIEW messages AS SELECT 1 AS topic_id")
    database.commit()
    database.close()
    return path / "bag.db3", "it lacks the tables `topics` and `messages`"


def without_messages(path, _):
    with (path / "bag.mcap").open("wb") as file:
        writer = McapWriter(file)
        writer.start(profile="ros2")
        writer.finish()
    return path / "bag.mcap", "it has no messages"


BROKEN = (
    *(empty, cut_off, no_mcap, one_byte_changed, a_length_of_exabytes, bomb, nothing),
    *(an_empty_folder, another_file, broken_metadata, metadata_without_files, a_missing_file),
    *(no_database, another_database, without_messages),
)


@pytest.mark.parametrize("breaks", BROKEN, ids=lambda breaks: breaks.__name__)
def test_a_recording_that_cannot_be_used_is_reported_by_its_name(breaks, whole, tmp_path, capsys):
    bag, said = breaks(tmp_path, whole)
    assert main(["grade", str(SCENARIO), str(bag)]) == 2
    reported = capsys.readouterr().err
    assert reported.startswith(str(bag)) or str(tmp_path) in reported.split(":")[0]
    assert said in reported
    assert "Traceback" not in reported


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--objects", "/nowhere"], f"has no topic /nowhere\n  topics with poses there: {POSES}"),
        (["--objects", "/joint_states"], "/joint_states is of type sensor_msgs/msg/JointState"),
        (["--object", "green_cylinder=" + POSES], "which has no poses of objects"),
        (["--object", "cylinder"], "'cylinder' is not NAME=TOPIC"),
        (
            ["--joint-states", "/arm/joints"],
            "topics of joint states: /joint_states (--joint-states",
        ),
        (["--set", "robot.model=open_manipulator_x"], ""),
    ],
)
def test_wrong_names_are_reported_with_the_right_ones(words, said, whole, capsys):
    try:
        code = main(["grade", str(SCENARIO), str(whole), *words])
    except SystemExit as error:
        code = error.code
    assert code == 2
    assert said in capsys.readouterr().err


def test_a_recording_larger_than_what_is_kept_is_refused_while_it_is_read(whole, monkeypatch):
    read = []

    def counted(files):
        for message in storage.messages(files):
            read.append(message.topic)
            yield message

    monkeypatch.setattr(reader, "BAG_NUMBERS", 5_000)
    monkeypatch.setattr(reader, "messages", counted)
    with pytest.raises(SpecError, match="holds more than 5000 numbers of joints and frames"):
        reader.read_bag(whole, GAZEBO)
    assert len(read) < 400
