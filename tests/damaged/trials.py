"""One damaged input per seed, and the commands that read it.

By hand, many of them: `python -m tests.damaged.trials KIND FIRST COUNT`.
"""

from __future__ import annotations

import json
import random
import shutil
import sys
import tempfile
import traceback
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from harness.core.resources import data_folder
from harness.plugins.ros.bag.write import BagOptions, write_bag
from harness.recording.read_run import read_run
from tests.damaged.front_door import assert_ends_well
from tests.damaged.mutants import (
    damaged_arrays,
    damaged_bytes,
    damaged_document,
    damaged_text,
    npz_bytes,
)
from tests.running import run_case

TINY = """\
scenario: a tiny run
robot: open_manipulator_x
objects:
  - {name: block, box: {size: [4 cm, 4 cm, 4 cm]}, mass: 0.1, pose: {xyz: [0.25, 0.1, 0.02]}}
  - {name: floor, box: {size: [2, 2, 0.1]}, static: true, pose: {xyz: [0, 0, -0.05]}}
steps:
  - id: near
    move_to: {joints: {joint1: 0.05}}
    expect: [{joints: {positions: {joint1: 0.05}}}, upright: block]
  - move_to: {pose: {xyz: [0.9, 0, 0.1]}}
    expect_error: NO_IK_SOLUTION
  - wait: 10 ms
expect:
  - never: collision
  - clearance: {between: [robot, block], at_least: 1 cm}
  - always: within_limits
"""
TASTES = (
    "signals bytes", "signals", "signals", "document bytes", "document", "document", "document",
    "visuals bytes", "visuals", "resolved",
)  # fmt: skip


def tiny_scenario(folder: Path) -> Path:
    """The scenario of the tiny run, as a file."""
    file = folder / "tiny.scenario.yaml"
    file.write_text(TINY)
    return file


def tiny_run(folder: Path) -> Path:
    """A small run with steps that succeed and fail, objects and contacts; and its bags."""
    scenario = tiny_scenario(folder)
    result = run_case(scenario, report_dir=folder / "run", stills=False, page=False)
    assert result.outcome == "passed", (result.message, result.verdicts, result.problems)
    for storage in ("mcap", "sqlite3"):
        write_bag(folder / storage, read_run(folder / "run"), BagOptions(storage, rate=20))
    return folder / "run"


def damage_run(run: Path, rng: random.Random) -> str:
    """Damage one file of a run's folder; returns which."""
    taste = rng.choice(TASTES)
    name, _, how = taste.partition(" ")
    names = {"signals": "signals.npz", "visuals": "visuals.npz", "document": "run.json"}
    path = run / names.get(name, "scenario.resolved.yaml")
    if how == "bytes":
        path.write_bytes(damaged_bytes(path.read_bytes(), rng))
    elif name == "document":
        document = damaged_document(json.loads(path.read_text()), rng)
        path.write_text(json.dumps(document))
    elif name == "resolved":
        path.write_bytes(damaged_text(path.read_text(), rng))
    else:
        with np.load(path) as file:
            arrays = dict(file)
        path.write_bytes(npz_bytes(damaged_arrays(arrays, rng)) if arrays else b"")
    return taste


def run_trial(base: Path, seed: int) -> list[int]:
    """A damaged run, judged, shown, compared and exported; the exit codes."""
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory() as place:
        run = Path(place) / "run"
        shutil.copytree(base / "run", run)
        damage_run(run, rng)
        bag, urdf = Path(place) / "bag", Path(place) / "robot.urdf"
        return [
            assert_ends_well("judge", run, "--contacts"),
            assert_ends_well("view", run, "--rebuild", "--no-open"),
            assert_ends_well("compare", base / "run", run),
            assert_ends_well("export", run, "--bag", bag, "--urdf", urdf),
        ]


def bag_trial(base: Path, seed: int) -> list[int]:
    """A damaged bag, graded; the exit code."""
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory() as place:
        bag = Path(place) / "bag"
        shutil.copytree(base / rng.choice(("mcap", "sqlite3")), bag)
        [recorded] = (file for file in bag.iterdir() if file.suffix in (".mcap", ".db3"))
        damaged = recorded if rng.random() < 0.9 else bag / "metadata.yaml"
        damaged.write_bytes(damaged_bytes(damaged.read_bytes(), rng))
        return [assert_ends_well("grade", base / "tiny.scenario.yaml", bag)]


SDF_WORLDS = (
    """\
<sdf version="1.9">
  <world name="lab">
    <gravity>0 0 -9.8</gravity>
    <physics name="fast" type="ode"><max_step_size>0.001</max_step_size></physics>
    <model name="table">
      <static>true</static>
      <pose>0.3 0 0.05 0 0 0</pose>
      <link name="top">
        <collision name="board"><geometry><box><size>0.2 0.2 0.1</size></box></geometry></collision>
        <visual name="board"><geometry><box><size>0.2 0.2 0.1</size></box></geometry></visual>
      </link>
    </model>
    <frame name="mark" attached_to="table"><pose>0 0 0.1 0 0 0.5</pose></frame>
    <model name="can">
      <pose relative_to="mark">0 0 0.06 0 0 0</pose>
      <link name="body">
        <inertial>
          <mass>0.2</mass>
          <inertia><ixx>0.001</ixx><iyy>0.001</iyy><izz>0.001</izz></inertia>
        </inertial>
        <collision name="side">
          <geometry><cylinder><radius>0.03</radius><length>0.1</length></cylinder></geometry>
          <surface><friction><ode><mu>0.8</mu><mu2>0.8</mu2></ode></friction></surface>
        </collision>
        <visual name="side">
          <geometry><cylinder><radius>0.03</radius><length>0.1</length></cylinder></geometry>
          <material><diffuse>0.8 0.1 0.1 1</diffuse></material>
        </visual>
        <sensor name="eye" type="camera">
          <update_rate>5</update_rate>
          <camera>
            <horizontal_fov>1.0</horizontal_fov>
            <image><width>32</width><height>24</height></image>
            <clip><near>0.01</near><far>10</far></clip>
          </camera>
        </sensor>
      </link>
    </model>
  </world>
</sdf>
""",
)
ROBOT = """\
scenario: a robot of a folder
robot: {model: ./robot}
steps:
  - gripper: open
  - move_to: home
"""
IMPORTED = """\
scenario: a robot of a URDF and an SRDF
robot: {urdf: robot/open_manipulator_x.urdf, srdf: robot/open_manipulator_x.srdf, gripper: gripper}
steps:
  - gripper: open
  - move_to: home
"""
GRIPPER = """\
scenario: an arm with a gripper of a folder
robot: {model: ur3e, gripper: ./robot}
steps: [{gripper: open}, {gripper: {width: 5 cm}}]
"""
OF_ROBOTS = (
    ("open_manipulator_x", ROBOT),
    ("open_manipulator_x", IMPORTED),
    ("rh_p12_rn_a", GRIPPER),
)


def robot_trial(base: Path, seed: int) -> list[int]:
    """A robot's folder with a damaged file: checked, and run where the check accepts it."""
    del base
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory() as place:
        name, scenario = rng.choice(OF_ROBOTS)
        shutil.copytree(data_folder("robots") / name, Path(place) / "robot")
        files = sorted((Path(place) / "robot").glob("*.[usy]*"))
        damaged = rng.choice(files)
        damaged.write_bytes(damaged_text(damaged.read_text(), rng))
        return [*_checked_and_run(Path(place), scenario)]


WORLD = """\
scenario: a world of SDF
robot: open_manipulator_x
world: {name: ./world.sdf}
steps: [{wait: 10 ms}]
"""


def world_trial(base: Path, seed: int) -> list[int]:
    """A damaged world in SDF: checked, and run where the check accepts it."""
    del base
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory() as place:
        text = rng.choice(SDF_WORLDS)
        (Path(place) / "world.sdf").write_bytes(damaged_text(text, rng))
        return [*_checked_and_run(Path(place), WORLD)]


def _checked_and_run(folder: Path, scenario: str) -> Iterator[int]:
    file = folder / "damaged.scenario.yaml"
    file.write_text(scenario)
    code = assert_ends_well("check", file)
    yield code
    if code == 0:
        yield assert_ends_well("run", file, "--no-report", "--in-process")


TRIALS = {"run": run_trial, "bag": bag_trial, "robot": robot_trial, "world": world_trial}


def _by_hand(kind: str, first: int, count: int) -> None:
    """Print every input that ends badly, and how many ended with which exit codes."""
    codes: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as place:
        if kind in ("run", "bag"):
            tiny_run(Path(place))
        for seed in range(first, first + count):
            try:
                codes[str(TRIALS[kind](Path(place), seed))] += 1
            except Exception:  # noqa: BLE001 - every kind of bad end is counted
                codes["bad"] += 1
                sys.stdout.write(f"=== {kind} {seed}\n{traceback.format_exc()}\n")
    sys.stdout.write(f"{codes}\n")


if __name__ == "__main__":
    _by_hand(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
