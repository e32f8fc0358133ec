"""A second robot that rests far away changes nothing of what the first one does, to the bit.

The digest of a run covers all its robots. Compared here is the part of it that is of the first
robot: its trajectories, the signals of its joints and sensors, all poses of objects, and all
contacts that are not the second robot's.
"""

import hashlib

import numpy as np
import pytest

from harness.recording.arrays import arrays_of
from harness.recording.read_run import read_run

OMX, UR = "open_manipulator_x", "ur5e, gripper: rh_p12_rn_a"
FAR = {
    "the same robot": f"{OMX}, base: {{xyz: [0, -3, 0]}}",
    "the same robot elsewhere": f"{OMX}, base: {{xyz: [-5, 2, 0.4], rpy: [0, 0, 40 deg]}}",
    "another robot": f"{UR}, base: {{xyz: [4, -7, 1]}}, wrench_sensors: {{wrist: rh_p12_rn_base}}",
    "another gripper": "ur5e, gripper: suction_cup, base: {xyz: [4, -7, 1]}",
    "another robot, declared first": f"{UR}, base: {{xyz: [-3, 5, 0]}}",
}
PICK = """\
near: {model: open_manipulator_x, base: {xyz: [0, 0.17, 0]}}
objects:
  - {name: can, cylinder: {radius: 15 mm, length: 6 cm}, mass: 0.05,
     pose: {xyz: [0.22, 0.17, 0.03]}}
steps:
  - pick: can
    robot: near
  - move_to: {position: {xyz: [0.18, 0.27, 0.12]}}
    robot: near
  - place: {object: can, pose: {xyz: [0.2, 0.2, 0.031]}}
    robot: near
expect:
  - lifted: {object: can, above: 5 cm, by: near}
  - placed: {object: can, pose: {xyz: [0.2, 0.2, 0.03]}}
  - never: collision
"""
PUSH = """\
near: {model: ur5e, gripper: rh_p12_rn_a}
objects:
  - {name: crate, mass: 2 kg, friction: 0.4, box: {size: [20 cm, 20 cm, 20 cm]},
     pose: {xyz: [0.5, 0.2, 0.1]}}
steps:
  - gripper: close
    robot: near
  - move_to: {pose: {xyz: [0.5, -0.05, 0.12], rpy: [180 deg, 0, 0]}}
    robot: near
  - robot: near
    allow_collisions:
      pairs: [[gripper, crate], [crate, ground_plane]]
      during:
        - lin: {pose: {xyz: [0.5, 0.07, 0.12], rpy: [180 deg, 0, 0]}}
          robot: near
        - lin: {pose: {xyz: [0.5, 0.2, 0.12], rpy: [180 deg, 0, 0]},
                cartesian_limits: {max_trans_vel: 10 cm/s}}
          robot: near
expect:
  - displaced: {object: crate, at_least: 10 cm}
"""
PRESS = """\
near: {model: ur5e, gripper: rh_p12_rn_a,
       wrench_sensors: {wrist: {link: rh_p12_rn_base, force_noise: 0.1}}}
objects:
  - {name: block, static: true, box: {size: [20 cm, 20 cm, 15 cm]}, pose: {xyz: [0.5, 0.1, 0.075]}}
steps:
  - gripper: close
    robot: near
  - move_to: {pose: {xyz: [0.5, 0.1, 0.19], rpy: [180 deg, 0, 0]}}
    robot: near
  - tare: near_wrist
  - robot: near
    allow_collisions:
      pairs: [[gripper, block]]
      during:
        - move_until: {direction: {xyz: [0, 0, -1]}, force: 40 N, max_distance: 8 cm, speed: 5 mm/s}
          robot: near
        - wait: 0.2 s
expect:
  - in_contact: {between: [near, block]}
"""
BELT = """\
near: {model: ur3e, gripper: rh_p12_rn_a}
objects:
  - {name: belt, static: true, box: {size: [1.6, 0.25, 0.1]}, pose: {xyz: [0.1, 0.28, 0.05]},
     surface_velocity: 10 cm/s}
  - {name: box, box: {size: [4 cm, 6 cm, 5 cm]}, pose: {xyz: [-0.4, 0.28, 0.125]}, mass: 0.2,
     friction: 0.6}
steps:
  - pick: {object: box, track: true}
    robot: near
  - conveyor: {object: belt, velocity: 0}
expect:
  - lifted: {object: box, above: 5 cm, by: near}
"""
STACKS = PICK.replace(
    "steps:\n",
    "".join(
        f"  - {{name: b{number}, box: {{size: [3 cm, 3 cm, 3 cm]}}, mass: 0.1,\n"
        f"     pose: {{xyz: [-0.3, 0.{number}, 0.015]}}}}\n"
        for number in range(1, 9)
    )
    + "steps:\n",
)
"""With nine objects, whose matrices MuJoCo makes sparse."""
NOISE = PICK.replace(
    "steps:\n",
    "steps:\n  - inject: {sensor_noise: 0.02 deg, command_latency: 4 ms}\n    robot: near\n",
)
COMPLY = PRESS.replace(
    "        - wait: 0.2 s\n",
    """\
        - robot: near
          comply:
            stiffness: {x: 2 kN/m, y: 2 kN/m}
            wrench: {z: -10 N}
            during:
              - wait: 0.3 s
""",
)
SCENES = {
    "pick": PICK,
    "comply": COMPLY,
    "noise": NOISE,
    "push": PUSH,
    "press": PRESS,
    "belt": BELT,
    "many objects": STACKS,
}
CASES = [("pick", far) for far in FAR] + [
    (scene, far)
    for scene in list(SCENES)[1:]
    for far in ("the same robot", "another robot, declared first")
]


def text(scene, far=None):
    robot, rest = SCENES[scene].split("\nobjects:")
    robots = [robot] if far is None else [robot, f"far: {{model: {FAR[far]}}}"]
    if far and far.endswith("first"):
        robots.reverse()
    lines = "\n".join(robots).splitlines()
    return (
        f"scenario: {scene}\nrobots:\n"
        + "".join(f"  {each}\n" for each in lines)
        + "objects:"
        + rest
    )


def of_near(stored):
    """Everything recorded of the first robot and of what it acts on, by name."""
    run = stored.run
    own = [place for place, name in enumerate(run.robot.joint_names) if name.startswith("near_")]
    found = {}
    for name, values in arrays_of(run.signals).items():
        if "far" in name or name.startswith(("tcp_pose", "frames", "clearance", "distances")):
            continue  # of which links poses and distances are recorded depends on the robots
        found[name] = values[:, own] if name.startswith("joint_") else values
    for step in run.steps:
        if step.trajectory is not None:
            for part in ("times", "positions", "velocities", "accelerations"):
                found[f"{step.path} {part}"] = getattr(step.trajectory, part)
    return found


def digest(found):
    hasher = hashlib.sha256()
    for name, values in sorted(found.items()):
        hasher.update(name.encode() + np.ascontiguousarray(values).tobytes())
    return hasher.hexdigest()


@pytest.mark.nightly
@pytest.mark.parametrize(("scene", "far"), CASES)
def test_a_far_robot_that_rests_changes_nothing_of_the_first_ones_motions(scene, far, recorded_run):
    alone, with_far = (
        read_run(recorded_run(each) / "run") for each in (text(scene), text(scene, far))
    )
    first, second = of_near(alone), of_near(with_far)
    assert {name.split(" ")[-1] for name in first} >= {"positions", "joint_efforts"}
    differing = [name for name in first if not np.array_equal(first[name], second.get(name), True)]
    assert not differing
    assert first.keys() == second.keys()
    assert digest(first) == digest(second)
    for verdict, other in zip(alone.verdicts, with_far.verdicts, strict=True):
        assert (verdict.status, verdict.margin) == (other.status, other.margin)
