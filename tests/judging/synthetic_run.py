"""A run made by hand: one arm joint, two fingers, a table, a box; 100 samples a second.

The robot is `base_link` (static), `arm_link`, `palm`, `left_finger`, `right_finger`; its joints are
`shoulder` (turning), `finger` (sliding). The box is a 4 cm cube that stands on a table whose top is
at z = 0; the cylinder is like it, but round.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from harness.core.geometry import Box, Cylinder, Shape
from harness.core.spatial import SE3
from harness.judging.judge import judge
from harness.judging.placed import PlacedExpectation
from harness.recording.run import AttachmentRecord, ObjectRecord, Run
from harness.recording.signals import Signals
from harness.recording.step_record import StepRecord
from harness.recording.step_results import SavedDetails, SavedResult
from harness.robot.description import NamedState, PlanningGroup, RobotDescription
from harness.robot.end_effector import Gripper
from harness.robot.mechanism import Joint, Link, fixed_joint
from tests.approved import SAID, verdict_text

DT = 0.01


def joint(name, kind, parent, child, lower, upper, velocity, acceleration, effort):
    """A joint about or along the z axis of its parent."""
    limits = (lower, upper, velocity, acceleration, effort)
    return Joint(name, kind, parent, child, SE3.identity(), np.array([0.0, 0.0, 1.0]), *limits)


LINKS = ("world", "base_link", "arm_link", "palm", "left_finger", "right_finger")

POINTS = np.array([[0.0, 0.0], [0.03, 0.06]])

ROBOT = RobotDescription(
    name="hand",
    urdf="",
    srdf="",
    links=tuple(Link(name, None) for name in LINKS),
    joints=(
        fixed_joint("world_joint", "world", "base_link", SE3.from_xyz_rpy((0, 0, 0.5))),
        joint("shoulder", "revolute", "base_link", "arm_link", -1.0, 1.0, 2.0, 5.0, 10.0),
        fixed_joint("palm_joint", "arm_link", "palm", SE3.identity()),
        joint("finger", "prismatic", "palm", "left_finger", 0.0, 0.03, 0.5, 1.0, 20.0),
        fixed_joint("right_joint", "palm", "right_finger", SE3.identity()),
    ),
    groups={
        "arm": PlanningGroup("arm", ("shoulder",)),
        "gripper": PlanningGroup("gripper", ("finger",)),
    },
    named_states=(
        NamedState("home", "arm", {"shoulder": 0.0}),
        NamedState("open", "gripper", {"finger": 0.03}),
        NamedState("closed", "gripper", {"finger": 0.0}),
    ),
    allowed_collisions={("arm_link", "palm"): "Adjacent"},
    arm_group="arm",
    gripper=Gripper(
        "gripper",
        "finger",
        {"left": ("left_finger",), "right": ("right_finger",)},
        {"left": "left_finger", "right": "right_finger"},
        "palm",
        0.03,
        0.0,
        10.0,
        20.0,
        POINTS,
    ),
    tcp_link="palm",
    base_link="base_link",
    start_state={},
)


def thing(name, geometry=None, *, static=False, physics=True, mass=0.1, pose=()):
    """An object record."""
    shape = Shape(geometry or Box((0.04, 0.04, 0.04)))
    return ObjectRecord(name, static, True, physics, (shape,), ((0.0, 1e9),), pose, mass)


TABLE = thing("Table", Box((1.0, 1.0, 0.03)), static=True, mass=0.0)
BOX = thing("box")
CYLINDER = thing("cylinder", Cylinder(0.02, 0.04))


def at(n, xyz=(0.0, 0.0, 0.0), quat=(1.0, 0.0, 0.0, 0.0)):
    """The same pose n times, shape (n, 7); xyz may be an array of shape (n, 3)."""
    poses = np.empty((n, 7))
    poses[:, :3], poses[:, 3:] = xyz, quat
    return poses


def heights(z):
    """Poses above the origin at heights, shape (n, 7)."""
    z = np.asarray(z, dtype=float)
    poses = at(len(z))
    poses[:, 2] = z
    return poses


def make_run(n=200, *, objects=(TABLE, BOX), steps=(), attachments=(), robot=ROBOT, **signals):
    """A run of n samples in which nothing moves or touches, but for what is given."""
    columns = len(robot.joint_names)
    zero = np.zeros((n, columns))
    ajar = zero.copy()
    ajar[:, -1:] = 0.02  # the pads are 4 cm apart, as wide as the box
    poses = {"Table": at(n, (0, 0, -0.015)), "box": at(n, (0, 0, 0.02))}
    poses |= {"cylinder": at(n, (0, 0, 0.02))}
    names = {record.name for record in objects if record.in_simulation}
    given = {
        "times": np.arange(n) * DT,
        "joint_positions": ajar,
        "joint_velocities": zero,
        "joint_efforts": zero,
        "joint_commands": ajar,
        "joint_command_velocities": zero,
        "tcp_pose": at(n, (0, 0, 0.3)),
        "contact_forces": {},
        **signals,
    }
    given["object_poses"] = {
        name: pose
        for name, pose in (poses | signals.get("object_poses", {})).items()
        if name in names
    }
    run_fields = {
        key: given.pop(key) for key in ("allowed_contacts", "ended_early") if key in given
    }
    return Run(
        scenario="by hand",
        file="by_hand.scenario.yaml",
        case="",
        seed=0,
        robot=robot,
        objects=tuple(objects),
        attachments=tuple(attachments),
        steps=tuple(steps),
        signals=Signals(**given),
        **run_fields,
    )


def step(name, start, stop, verb="move_to", status="passed", **fields):
    """A step over samples [start, stop); its details are plain data, as run.json has them."""
    result = SavedResult(verb=verb, saved=fields.pop("result", {}))
    details = {
        name: SavedDetails(saved=fields.pop(name, {})) for name in ("planner", "explanation")
    }
    return StepRecord(
        id=name,
        path=fields.pop("path", f"steps[{start}]"),
        verb=verb,
        summary=verb,
        line=0,
        status=status,
        start_time=start * DT,
        end_time=(stop - 1) * DT,
        start_index=start,
        end_index=stop,
        result=result,
        **details,
        **fields,
    )


def followed(share):
    """The result of a Cartesian path that was followed to a share."""
    return {"fraction": share, "largest_joint_step": 0.01}


def gripped(*, stalled):
    """The result of a gripper step."""
    outcome = {"target": 0.0, "position": 0.0, "effort": 1.0, "reached_goal": not stalled}
    return {**outcome, "stalled": stalled, "contacts": {}}


def force(n, *spans, value=1.0):
    """Zero but for spans [start, stop) of samples."""
    values = np.zeros(n)
    for start, stop in spans:
        values[start:stop] = value
    return values


def pressed(force, place, direction):
    """Contact point and normal force where there is a force, shape (n, 6)."""
    rows = np.hstack([np.tile(place, (len(force), 1)), np.outer(force, direction)])
    return np.where(force[:, None] > 0, rows, np.nan)


def attachment(name, start, stop, *, represents=None, pose=None, link="palm", is_welded=False):
    """Attached over samples [start, stop), and welded to the hand if required."""
    return AttachmentRecord(
        name,
        link,
        start * DT,
        stop * DT,
        tuple((pose or SE3.identity()).as_vector()),
        represents or name,
        (start * DT, stop * DT) if is_welded else None,
    )


def lift_run(n=200, *, grip=(50, 200), leave=100, height=0.1, value=2.0, **changes):
    """A box on the table that is gripped, leaves the table, rises and moves with the hand.

    Each finger carries nearly half of its weight by friction, from a little before it leaves.
    """
    rise = np.zeros(n)
    rise[leave:] = np.minimum(np.arange(n - leave) * 0.002, height)
    forces = {
        ("left_finger", "box"): force(n, grip, value=value),
        ("right_finger", "box"): force(n, grip, value=value),
        ("Table", "box"): force(n, (0, leave)),
    }
    grips = {("left_finger", "box"): 1.0, ("right_finger", "box"): -1.0}
    given = {
        "object_poses": {"box": heights(0.02 + rise)},
        "tcp_pose": heights(0.05 + rise),
        "contact_forces": forces,
        "presses": {
            pair: pressed(forces[pair], (0, -0.02 * sign, 0), (0, sign, 0))
            for pair, sign in grips.items()
        },
        "frictions": {
            pair: np.outer(force(n, (leave - 20, grip[1])), (0, 0, 0.48)) for pair in grips
        },
        "steps": (
            step("approach", 0, 40),
            step("close", 39, 80, "gripper"),
            step("lift", 79, n),
        ),
    }
    return make_run(n, **{**given, **changes})


def verdict(run, spec, step_id=""):
    """The one verdict of an expectation."""
    (answer,) = judge(run, [PlacedExpectation(spec, step_id, 7)])
    assert answer.line == 7
    if answer.status == "passed":
        assert answer.margin >= 0, answer
    if answer.status == "failed" and not np.isnan(answer.margin):
        assert answer.margin <= 0, answer
    assert answer.reason, answer
    SAID.append(verdict_text(answer))
    return answer


def changed(run, **signals):
    """The same run with other signals."""
    return replace(run, signals=replace(run.signals, **signals))
