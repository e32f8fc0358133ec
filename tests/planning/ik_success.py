"""How often numeric inverse kinematics finds a random reachable goal. As a script, it renews the
page of the robots that states it: `python -m tests.planning.ik_success`, half a minute."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.core.spatial import pitch_of
from harness.language.scenario import RobotSpec
from harness.planning.ik.numeric import (
    MOST_RESTARTS,
    RESTARTS,
    LinkTask,
)
from harness.planning.ik.numeric import solve_numeric as solve
from harness.planning.ik.pose_table import SIZE
from harness.planning.model.robot_model import GroupSpace, RobotModel
from harness.plugins.motions.held_constraints import random_positions
from harness.ports.goals import PoseGoal, PositionGoal
from harness.robot.load import gripper_names, load_robot, robot_names

PAGE = Path(__file__).parents[2] / "docs/reference/inverse_kinematics.md"
RENEW = "python -m tests.planning.ik_success"
POSES = 1000
ATTEMPTS = (0, 4, RESTARTS, MOST_RESTARTS)
ARMS = tuple(name for name in robot_names() if name not in gripper_names())
KINDS = ("pose", "position and pitch", "position")

TEXT = """\
# Inverse kinematics of the bundled arms

Closed forms give every branch of a UR (up to eight) and of OpenMANIPULATOR-X (up to four) without a
search. Every other arm, and every goal without a closed form, is solved numerically: damped least
squares from the current joint positions and from {restarts} others, and from up to {most} while
there is no solution. Of a table of {size} random joint positions, always the same, these are the
ones that bring the link nearest to the goal. The same goal and positions give the same solutions.

The table shows how often the numeric solver finds a random reachable goal, measured on the bundled
arms as if they had no closed form: {poses} goals each, at joint positions drawn uniformly in the
limits. A goal counts as found when position and orientation are reached to 1e-8 (m, rad) within the
joint limits. The last column is an upper bound of the error of the solutions.

| arm | joints | goal | no restart | 4 restarts | {restarts} restarts | {most} restarts | error |
| --- | --- | --- | --- | --- | --- | --- | --- |
{rows}

Arms with fewer than six joints cannot reach every pose. With five joints the solver uses all of a
`pose` but its turn about the vertical, with four its position and pitch, with three its position.
The remaining error is in the record of the step (`ik_solutions`, `residual`) and must be within the
goal's `tolerance`; otherwise the step fails with GOAL_CONSTRAINTS_VIOLATED. The poses in the table
are reachable: they are those of joint positions of the arm.

`{renew}` writes this page; `python -m pytest -m nightly` compares it with new measurements.
"""


@dataclass(frozen=True)
class Success:
    """Goals found with each number of restarts, and the farthest that a solution missed by."""

    found: tuple[int, ...]
    poses: int
    residual: float


def measure(model: str, kind: str, poses: int) -> Success:
    """Goals are where the TCP is at joint positions drawn evenly inside the limits."""
    description = load_robot(RobotSpec.model_validate({"model": model}))
    start = description.start_positions()
    space = GroupSpace(RobotModel(description), description.arm_group, start)
    rng = np.random.default_rng(2024)
    found = [0] * len(ATTEMPTS)
    residual = 0.0
    for _ in range(poses):
        goal = _goal(kind, space, description.tcp_link, random_positions(space, rng))
        for place, restarts in enumerate(ATTEMPTS):
            solutions = solve(
                space,
                goal,
                space.part(start),
                most_restarts=restarts,
                enough=1,
            )
            if solutions:
                for later in range(place, len(ATTEMPTS)):
                    found[later] += 1
                error, _ = LinkTask(space, goal).evaluate(solutions[0])
                residual = max(residual, float(np.linalg.norm(error)))
                break
    return Success(tuple(found), poses, residual)


def _goal(kind, space, link, positions):
    pose = space.robot.link_pose(space.whole(positions), link)
    if kind == "pose":
        return PoseGoal(link, pose)
    pitch = pitch_of(pose.rotation) if kind == "position and pitch" else None
    return PositionGoal(link, pose.translation, pitch)


def page() -> str:
    """The table of all bundled arms, and what it means."""
    rows = [
        f"| `{model}` | {_joints(model)} | {kind} | {_row(measure(model, kind, POSES))} |"
        for model in ARMS
        for kind in KINDS
    ]
    return TEXT.format(
        poses=POSES,
        restarts=RESTARTS,
        size=SIZE,
        most=MOST_RESTARTS,
        renew=RENEW,
        rows="\n".join(rows),
    )


def _row(success: Success) -> str:
    rates = [f"{100 * count / success.poses:.1f} %" for count in success.found]
    return " | ".join([*rates, f"{_bound(success.residual):.0e}"])


def _joints(model: str) -> int:
    description = load_robot(RobotSpec.model_validate({"model": model}))
    return len(description.groups[description.arm_group].joint_names)


def _bound(residual: float) -> float:
    """The next power of ten: the digits below it are the processor's."""
    return float(10.0 ** np.ceil(np.log10(max(residual, 1e-15))))


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
