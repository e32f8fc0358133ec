"""Scenes that public threads request, in our own words; each runs, and is judged.

A naive counterpart of each has to fail: see the second test.
"""

import pytest

from tests.running import run_case

BELT = """
scenario: "mujoco#547, IsaacLab#3214, drake#19599: a belt of constant speed, and an arm that picks"
robot: {model: ur3e, gripper: rh_p12_rn_a}
objects:
  - {name: belt, static: true, box: {size: [1.6, 0.25, 0.1]}, pose: {xyz: [0.1, 0.28, 0.05]},
     surface_velocity: 10 cm/s}
  - {name: cube, box: {size: [5 cm, 5 cm, 5 cm]}, mass: 0.2, friction: 0.6,
     pose: {xyz: [-0.4, 0.28, 0.125]}}
steps:
  - {wait: 1 s, id: ride}
  - {pick: {object: cube, track: true}}
expect:
  - {formula: "always[0.5, 1] abs(speed(cube) - 0.1) < 1 mm/s", during: ride}
  - lifted: {object: cube, above: 5 cm}
  - grasped: cube
"""
TWO_ARMS = """
scenario: "ros_kortex#307, xarm_ros2#39, moveit#3381, mujoco_ros2_control#44: two arms in a cell"
robots:
  left: {model: ur5e, base: {xyz: [0, 0.45, 0]}}
  right: {model: ur5e, base: {xyz: [0, -0.45, 0]}}
steps:
  - parallel:
      - move_to: {pose: {xyz: [0.5, 0.15, 0.3], rpy: [180 deg, 0, 0]}}
        robot: left
      - move_to: {pose: {xyz: [0.5, -0.15, 0.3], rpy: [180 deg, 0, 0]}}
        robot: right
expect:
  - tcp_pose: {pose: {xyz: [0.5, 0.15, 0.3], rpy: [180 deg, 0, 0]}, by: left}
  - tcp_pose: {pose: {xyz: [0.5, -0.15, 0.3], rpy: [180 deg, 0, 0]}, by: right}
  - never: collision
"""
CUP = """
scenario: "robosuite#425, robosuite#122, mujoco#229: a disk too thin for fingers, by suction"
robot: {model: ur5e, gripper: suction_cup}
objects:
  - {name: large, cylinder: {radius: 6 cm, length: 1 cm}, mass: 0.1, friction: 0.6,
     pose: {xyz: [0.5, 0.2, 0.005]}}
  - {name: small, cylinder: {radius: 4 cm, length: 1 cm}, mass: 0.05, friction: 0.6,
     pose: {xyz: [0.5, 0.2, 0.015]}}
steps:
  - pick: small
    expect: [{grasped: small}]
  - {place: {object: small, pose: {xyz: [0.5, 0, 0.005]}}}
  - {settle: {}}
expect:
  - placed: {object: small, on: ground_plane, pose: {xyz: [0.5, 0, 0.005]},
      tolerance: {position: 5 mm}}
  - never: {displaced: {object: large, at_least: 5 mm}}
"""
DOOR = """
scenario: "ManiSkill-Legacy#17, habitat-lab#872: a cabinet door along the arc of its hinge"
robot: {model: ur5e, gripper: rh_p12_rn_a}
seed: 2
objects:
  - name: cabinet
    static: true
    pose: {xyz: [0.85, 0.1, 0.35]}
    box: {size: [30 cm, 40 cm, 40 cm]}
    joints:
      - name: door
        hinge: {axis: [0, 0, -1], at: [-0.16, 0.2, 0], range: [0, 110 deg], friction: 0.1}
        shapes:
          - {box: {size: [2 cm, 40 cm, 38 cm]}, pose: {xyz: [-0.162, 0, 0]}}
          - {name: handle, cylinder: {radius: 1 cm, length: 14 cm},
             pose: {xyz: [-0.22, -0.16, 0.1]}}
steps:
  - {open: {object: cabinet, joint: door, to: 60 deg}}
expect:
  - joint: {object: cabinet, joint: door, at_least: 58 deg}
  - never: collision
"""
FORCE = """
scenario: "mujoco#1249, mujoco#1276, IsaacGymEnvs#171: a motion stops at the force at a wrist"
robot: {model: ur5e, gripper: rh_p12_rn_a, wrench_sensors: {wrist: rh_p12_rn_base}}
objects:
  - {name: block, static: true, friction: 0, box: {size: [0.3, 0.3, 0.15]},
     pose: {xyz: [0.5, 0.1, 0.075]}}
steps:
  - gripper: close
  - {move_to: {pose: {xyz: [0.5, 0.1, 0.173], rpy: [180 deg, 0, 0]}}}
  - tare: wrist
  - allow_collisions:
      pairs: [[gripper, block]]
      during:
        - move_until: {direction: {xyz: [0, 0, -1]}, force: 20 N, sensor: wrist,
            max_distance: 5 cm, speed: 2 mm/s}
        - {wait: 0.3 s, id: press}
expect:
  - formula:
      formula: always (abs(force_x(wrist)) < 1 N and abs(force_y(wrist)) < 1 N and
        abs(abs(force_z(wrist)) - force(gripper, block)) < 0.2 N and force(gripper, block) > 15 N)
      force_window: 20 ms
      during: press
"""
SCENES = {"belt": BELT, "two arms": TWO_ARMS, "cup": CUP, "door": DOOR, "force": FORCE}
BROKEN = {
    "belt": ("surface_velocity: 10 cm/s", "surface_velocity: 5 cm/s"),
    "two arms": ("rpy: [180 deg, 0, 0]}, by: left", "rpy: [170 deg, 0, 0]}, by: left"),
    "cup": ("mass: 0.05", "mass: 7.6"),
    "door": ("range: [0, 110 deg], friction: 0.1", "range: [0, 110 deg], friction: 100"),
    "force": ("friction: 0, box", "friction: 1, box"),
}
"""What is changed in a scene, so that its verdict has to change: a slower belt, another goal, a
disk whose lift takes more than the vacuum, a hinge that sticks, a rough block."""


def outcome(folder, text):
    file = folder / "request.scenario.yaml"
    file.write_text(text, encoding="utf-8")
    return run_case(file)


@pytest.mark.nightly
@pytest.mark.parametrize("name", SCENES)
def test_a_scene_that_public_threads_request_runs_and_is_judged(tmp_path, name):
    result = outcome(tmp_path, SCENES[name])
    assert result.outcome == "passed", (result.problems, result.steps, result.verdicts)
    assert result.verdicts


@pytest.mark.nightly
@pytest.mark.parametrize("name", BROKEN)
def test_its_verdict_is_another_when_the_scene_is_wrong(tmp_path, name):
    old, new = BROKEN[name]
    assert old in SCENES[name]
    assert outcome(tmp_path, SCENES[name].replace(old, new)).outcome == "failed"
