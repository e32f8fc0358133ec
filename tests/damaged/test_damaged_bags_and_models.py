"""Damaged bags, robots and worlds, and numbers beyond all bounds, end with a located error."""

import shutil
import sqlite3
import struct

import pytest
import yaml
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter

from tests.damaged.front_door import assert_ends_well, outcome_of
from tests.damaged.mutants import places_in, put
from tests.damaged.trials import (
    SDF_WORLDS,
    WORLD,
    bag_trial,
    robot_trial,
    tiny_run,
    world_trial,
)


@pytest.fixture(scope="module")
def base(tmp_path_factory):
    folder = tmp_path_factory.mktemp("base")
    tiny_run(folder)
    return folder


def assert_refused(bag, base, *said):
    code, printed = outcome_of("grade", base / "tiny.scenario.yaml", bag)
    assert code == 2, printed
    assert "Traceback" not in printed
    for word in (str(bag), *said):
        assert word in printed


@pytest.mark.nightly(only=["a text of 4 GB"])
@pytest.mark.parametrize(
    "record",
    [
        b"\x03" + struct.pack("<Q", 6) + struct.pack("<HI", 1, 2**32 - 1),
        b"\x03" + struct.pack("<Q", 10) + struct.pack("<HI", 1, 4) + b"\xff\xfe\xfd\xfc",
        b"\x05" + struct.pack("<Q", 3) + b"abc",
        b"\x06" + struct.pack("<Q", 2**62),
        b"\x08" + struct.pack("<Q", 8) + struct.pack("<II", 2**32 - 1, 1),
    ],
    ids=["a text of 4 GB", "no UTF-8", "three bytes", "a chunk of exabytes", "a long index"],
)
def test_a_damaged_record_of_an_mcap_file_is_refused(record, base, tmp_path):
    bag = tmp_path / "bag.mcap"
    with bag.open("wb") as file:
        writer = McapWriter(file, compression=CompressionType.NONE, use_chunking=False)
        writer.start(profile="ros2")
        file.flush()
    bag.write_bytes(bag.read_bytes() + record)
    assert_refused(bag, base)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("UPDATE topics SET name = CAST(X'2F6AFFFE' AS TEXT)", "has no /joint_states"),
        ("UPDATE topics SET type = CAST(X'FF' AS TEXT)", "has no /joint_states"),
        ("UPDATE messages SET data = zeroblob(8)", "can be read"),
        ("ALTER TABLE topics RENAME COLUMN type TO kind", "cannot be read as a database"),
    ],
)
def test_a_damaged_database_is_refused(change, said, base, tmp_path):
    bag = shutil.copytree(base / "sqlite3", tmp_path / "bag")
    [file] = bag.glob("*.db3")
    with sqlite3.connect(file) as database:
        database.execute(change)
    database.close()
    assert_refused(bag, base, said)


def test_a_table_name_that_is_no_text_is_no_traceback(base, tmp_path):
    bag = shutil.copytree(base / "sqlite3", tmp_path / "bag")
    [file] = bag.glob("*.db3")
    file.write_bytes(file.read_bytes().replace(b"messages", b"mess\xff\xfees"))
    assert_refused(bag, base, "lacks the tables `topics` and `messages`")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('sensor name="eye"', 'sensor name=""', "world.sdf:"),
        ('model name="can"', 'model name=" "', "is not a name"),
        ('link name="top"', 'link name=""', "is not a name"),
        ("<radius>0.03</radius>", "<radius>1e308</radius>", "1e+308 is too large"),
        ("<radius>0.03</radius>", "<radius>5e-324</radius>", "at least 1e-09"),
        ("<size>0.2 0.2 0.1</size>", "<size>0.2 1e308 0.1</size>", "1e+308 is too large"),
        ("<gravity>0 0 -9.8</gravity>", "<gravity>0 0 1e308</gravity>", "1e+308 is too large"),
        ("<mass>0.2</mass>", "<mass>1e308</mass>", "1e+308 is too large"),
        ("<mass>0.2</mass>", "<mass>5e-324</mass>", "is too small"),
        ("<mass>0.2</mass>", "<mass>1e-12</mass>", "1e-12 is too small"),
        ("<pose>0.3 0 0.05 0 0 0</pose>", "<pose>-1e308 0 0 0 0 0</pose>", "is too large"),
        ("<far>10</far>", "<far>1e308</far>", "1e+308 is too large"),
    ],
)
def test_an_empty_name_or_a_number_beyond_bounds_in_sdf_is_located(old, new, said, tmp_path):
    [text] = SDF_WORLDS
    assert old in text
    (tmp_path / "world.sdf").write_text(text.replace(old, new, 1))
    (tmp_path / "a.scenario.yaml").write_text(WORLD)
    code, printed = outcome_of("check", tmp_path / "a.scenario.yaml")
    assert code == 2, printed
    assert "world.sdf:" in printed
    assert said in printed


NUMBERS = """\
scenario: numbers everywhere
seed: 3
robot:
  model: open_manipulator_x
  base: {xyz: [0.1, 0.0, 0.2], rpy: [0.0, 0.0, 0.1]}
objects:
  - name: box
    box: {size: [0.04, 0.04, 0.04]}
    mass: 0.1
    pose: {xyz: [0.25, 0.1, 0.02], rpy: [0.0, 0.0, 0.3]}
  - {name: ball, sphere: {radius: 0.02}, mass: 0.1, pose: {xyz: [0.25, -0.1, 0.02]}}
  - {name: rod, cylinder: {radius: 0.02, length: 0.1}, mass: 0.1, pose: {xyz: [0.3, 0.3, 0.05]}}
steps:
  - move_to: {joints: {joint1: 0.05}}
  - move_to: {pose: {xyz: [0.2, 0.0, 0.15], rpy: [0.0, 0.5, 0.0]}}
    planning: {max_velocity_scaling_factor: 0.5}
  - move_relative: {direction: {xyz: [0.0, 0.0, 1.0]}, distance: 0.01}
  - gripper: {position: 0.01, max_effort: 5.0}
  - wait: 0.01
expect:
  - clearance: {between: [robot, box], at_least: 0.01}
  - duration: {at_most: 20.0}
"""
DOCUMENT = yaml.safe_load(NUMBERS)


def value_at(place):
    inner = DOCUMENT
    for key in place:
        inner = inner[key]
    return inner


NUMERIC = [place for place in places_in(DOCUMENT) if isinstance(value_at(place), int | float)]


@pytest.mark.nightly(
    but=[
        "steps.1.move_to.pose.xyz.2",
        "robot.base.rpy.0",
        "objects.1.pose.xyz.1",
    ]
)
@pytest.mark.parametrize("place", NUMERIC, ids=lambda place: ".".join(map(str, place)))
def test_no_number_of_a_scenario_ends_a_check_in_a_traceback(place, tmp_path):
    file = tmp_path / "numbers.scenario.yaml"
    for number in (1e308, -1e308, 1e10, -1.0, 5e-324):
        file.write_text(yaml.safe_dump(put(DOCUMENT, place, number), sort_keys=False))
        code = assert_ends_well("check", file)
        if abs(number) > 1e9:
            assert code == 2, (place, number)


@pytest.mark.parametrize(
    "place",
    [
        ("robot", "base", "xyz", 0),
        ("objects", 1, "sphere", "radius"),
        ("steps", 2, "move_relative", "distance"),
    ],
)
def test_a_number_beyond_bounds_is_located_in_the_scenario(place, tmp_path):
    file = tmp_path / "numbers.scenario.yaml"
    file.write_text(yaml.safe_dump(put(DOCUMENT, place, 1e308), sort_keys=False))
    code, printed = outcome_of("check", file)
    assert code == 2
    assert printed.startswith(f"{file}:")
    assert "1e+308 is too large" in printed


@pytest.mark.nightly(but=["0", "1", "2", "3", "4", "5", "6", "7"])
@pytest.mark.parametrize("seed", range(60))
def test_no_damaged_bag_ends_in_a_traceback(base, seed):
    bag_trial(base, seed)


@pytest.mark.nightly(but=[0, 1, 2, 5])
@pytest.mark.parametrize("seed", range(40))
def test_no_damaged_robot_ends_in_a_traceback(base, seed):
    robot_trial(base, seed)


@pytest.mark.parametrize("seed", range(40))
def test_no_damaged_world_ends_in_a_traceback(base, seed):
    world_trial(base, seed)
