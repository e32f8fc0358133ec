"""Kinematics of a composed robot, with an analytic inverse where one exists, else a numeric one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from harness.core.errors import PlanningFailed
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.planning.ik.answer import IkAnswer, LimitedSolution, MissedSolution
from harness.planning.ik.nearest_pose import distance_to_goal
from harness.planning.ik.numeric import LinkGoal, LinkTask, pitch_of, solve_numeric
from harness.planning.ik.open_manipulator import (
    PlanarArm,
    headings,
    is_planar_arm,
    pitch_in_plane,
    pitches_below,
    solve_planar,
)
from harness.planning.ik.ur import UrGeometry, is_ur_like, solve_ur
from harness.planning.model.robot_model import GroupSpace, RobotModel
from harness.planning.model.turns import is_within, turn_from
from harness.ports import PoseGoal, PositionGoal
from harness.recording.goal_failures import LinkFailure
from harness.robot.description import Joint, RobotDescription
from harness.robot.forward_kinematics import LinkPoses, quats_wxyz

WHOLE_POSE_JOINTS, PITCH_JOINTS = 6, 4
"""Joints that an arm needs for an arbitrary pose, and for an arbitrary position and pitch."""

PITCH_SAMPLES = 73
"""Pitches tried for a position goal that leaves the pitch free: every 5 degrees of a whole turn."""

_POLISHED = 1e-7  # [m, rad] largest error of a closed-form solution after refinement
_LIMIT_SLACK = 1e-9  # [rad] a solution this far outside a limit is set to the limit


class PinocchioKinematics:
    """The port `Kinematics` for a composed robot."""

    def __init__(self, description: RobotDescription) -> None:
        self.description = description
        self.robot = RobotModel(description)

    def link_pose(self, joint_positions: FloatArray, link: str) -> SE3:
        """T_world_link at joint positions in description order."""
        return self.robot.link_pose(np.asarray(joint_positions, dtype=float), link)

    def link_poses(self, joint_positions: FloatArray, links: Sequence[str]) -> FloatArray:
        """T_world_link of many samples: (N, n) -> (N, len(links), 7), xyz and quat wxyz."""
        poses = LinkPoses(self.description, joint_positions, links)
        return np.stack(
            [
                np.hstack([poses.translations[link], quats_wxyz(poses.rotations[link])])
                for link in links
            ],
            axis=1,
        )

    def solve(
        self, group: str, goal: PoseGoal | PositionGoal, seed_positions: FloatArray, seed: int
    ) -> Sequence[FloatArray]:
        """Every known solution within position limits, nearest to `seed_positions` first."""
        space = GroupSpace(self.robot, group, seed_positions)
        return self.analyse(space, goal, seed_positions, seed).solutions

    def analyse(
        self, space: GroupSpace, goal: LinkGoal, seed_positions: FloatArray, seed: int
    ) -> IkAnswer:
        """Solve inverse kinematics and classify every candidate.

        Raises:
            PlanningFailed: INVALID_LINK_NAME, when the link is not moved by the group alone.
        """
        self._check_link(space, goal.link)
        if isinstance(goal, PoseGoal) and space.group in self.description.position_only_groups:
            point = goal.pose.translation
            goal = PositionGoal(goal.link, point, position_tolerance=goal.position_tolerance)
        reference = space.part(seed_positions)
        joints = tuple(self.description.joint_by_name[name] for name in space.joint_names)
        T_last_link = self._fixed_offset(joints[-1], goal.link)
        solver = self.description.ik_solver
        whole_pose = isinstance(goal, PoseGoal)
        excess = 0.0
        if solver in ("ur", "auto") and whole_pose and is_ur_like(joints):
            method = "ur"
            raw, excess = self._ur(joints, T_last_link, goal, reference)
        elif solver in ("open_manipulator_x", "auto") and is_planar_arm(joints, T_last_link):
            method = "open_manipulator_x"
            raw, excess = self._planar(joints, T_last_link, goal, space, seed_positions)
        else:
            method = "numeric"
            raw = solve_numeric(space, goal, reference, seed)
            if whole_pose and not raw and space.dof < WHOLE_POSE_JOINTS:
                raw = solve_numeric(space, reduced(space, goal), reference, seed)
        inside, outside, missed = self._sort(space, goal, raw, reference, polish=method == "ur")
        task = task_of(space, goal)
        return IkAnswer(tuple(inside), tuple(outside), excess, method, task, tuple(missed))

    def residual(
        self, space: GroupSpace, goal: LinkGoal, positions: FloatArray
    ) -> tuple[float, float]:
        """Position error [m] and orientation error [rad] of a goal at group positions."""
        return distance_to_goal(goal, self.link_pose(space.whole(positions), goal.link))

    def _sort(
        self,
        space: GroupSpace,
        goal: LinkGoal,
        raw: Iterable[FloatArray],
        reference: FloatArray,
        *,
        polish: bool,
    ) -> tuple[list[FloatArray], list[LimitedSolution], list[MissedSolution]]:
        """Refine candidates, turn them into the limits, and sort them: inside, outside, missed."""
        task = LinkTask(space, goal)
        inside: list[FloatArray] = []
        outside: list[LimitedSolution] = []
        missed: list[MissedSolution] = []
        for positions in raw:
            if polish:
                exact, error = task.polish(positions)
                if error > _POLISHED:
                    continue
            else:
                exact = positions
                pose = task.link_pose(exact)
                if not meets_tolerance(goal, pose):
                    missed += self._missed(space, goal, exact, pose, reference)
                    continue
            turned = into_limits(space, exact, reference)
            if isinstance(turned, LimitedSolution):
                outside.append(turned)
            elif all(space.distance(turned, other) > 1e-6 for other in inside):
                inside.append(turned)
        inside.sort(key=lambda q: (round(space.effort(reference, q), 9), tuple(q)))
        missed.sort(key=lambda one: (round(one.turn, 9), tuple(one.positions)))
        return inside, outside, missed

    def _missed(
        self,
        space: GroupSpace,
        goal: LinkGoal,
        positions: FloatArray,
        pose: SE3,
        reference: FloatArray,
    ) -> list[MissedSolution]:
        """The candidate as a missed solution if it reaches the position inside the limits."""
        kept = into_limits(space, positions, reference)
        shift, turn = distance_to_goal(goal, pose)
        at_the_point = isinstance(goal, PoseGoal) and shift <= goal.position_tolerance
        if isinstance(kept, LimitedSolution) or not at_the_point:
            return []
        return [MissedSolution(kept, pose, shift, turn)]

    def _ur(
        self, joints: tuple[Joint, ...], T_last_link: SE3, goal: PoseGoal, reference: FloatArray
    ) -> tuple[list[FloatArray], float]:
        T_world_base = self._base_pose(joints[0])
        T_base_wrist3 = T_world_base.inverse() @ goal.pose @ T_last_link.inverse()
        answer = solve_ur(UrGeometry.of_joints(joints), T_base_wrist3, float(reference[-1]))
        return list(answer.branches), max(answer.excess, 0.0)

    def _planar(
        self,
        joints: tuple[Joint, ...],
        T_last_link: SE3,
        goal: LinkGoal,
        space: GroupSpace,
        seed_positions: FloatArray,
    ) -> tuple[list[FloatArray], float]:
        arm = PlanarArm.of_joints(joints, T_last_link)
        T_base_world = self._base_pose(joints[0]).inverse()
        target = goal.pose.translation if isinstance(goal, PoseGoal) else goal.position
        position = T_base_world.apply(np.asarray(target, dtype=float))
        found: list[FloatArray] = []
        excesses: list[float] = []
        for heading in headings(arm, position):
            if isinstance(goal, PoseGoal):
                x_axis = T_base_world.rotation @ goal.pose.rotation[:, 0]
                pitches = [pitch_in_plane(heading, x_axis)]
            elif goal.pitch is not None:
                down = T_base_world.rotation @ np.array([0.0, 0.0, -1.0])
                pitches = list(pitches_below(heading, down, goal.pitch))
            else:
                now = float(space.part(seed_positions)[1:].sum())
                pitches = [now, *np.linspace(-np.pi, np.pi, PITCH_SAMPLES)]
            for pitch in pitches:
                answer = solve_planar(arm, position, heading, pitch)
                found.extend(answer.solutions)
                excesses.append(answer.excess)
        return found, min(excesses, default=0.0)

    def _check_link(self, space: GroupSpace, link: str) -> None:
        if link not in self.description.link_names:
            raise PlanningFailed("INVALID_LINK_NAME", f"the robot has no link '{link}'")
        moves_with = {self.robot.model.names[self.robot.parent_joint(link)]}
        if not moves_with & set(space.joint_names):
            raise PlanningFailed(
                "INVALID_LINK_NAME",
                f"link '{link}' is not moved by the joints of group '{space.group}'",
                LinkFailure(link, space.group),
            )

    def _fixed_offset(self, joint: Joint, link: str) -> SE3:
        """T_child_link from the joint's child link to a link that is fixed to it."""
        robot = self.robot
        return robot.placement(joint.child).inverse() @ robot.placement(link)

    def _base_pose(self, joint: Joint) -> SE3:
        """T_world_parent of the first joint's parent link, which is static."""
        return self.link_pose(np.zeros(len(self.description.joint_names)), joint.parent)


def task_of(space: GroupSpace, goal: LinkGoal) -> str:
    """The quantities that are solved for; fewer than six joints cannot reach every pose."""
    if isinstance(goal, PositionGoal):
        return "position" if goal.pitch is None else "position and pitch"
    if space.dof >= WHOLE_POSE_JOINTS:
        return "pose"
    return "position and pitch" if space.dof >= PITCH_JOINTS else "position"


def reduced(space: GroupSpace, goal: PoseGoal) -> PositionGoal:
    """The part of a pose that an arm with fewer than six joints can choose."""
    pitch = pitch_of(goal.pose.rotation) if space.dof >= PITCH_JOINTS else None
    return PositionGoal(goal.link, goal.pose.translation, pitch)


def into_limits(
    space: GroupSpace, positions: FloatArray, reference: FloatArray
) -> FloatArray | LimitedSolution:
    """Shift a solution by whole turns into the limits, nearest to a reference."""
    turned = np.array(positions, dtype=float)
    worst: tuple[float, int, float] | None = None  # excess, joint, limit
    turn = 2 * np.pi
    for index in range(space.dof):
        lower, upper = space.lower[index] - _LIMIT_SLACK, space.upper[index] + _LIMIT_SLACK
        value = turned[index]
        if space.wraps[index]:
            turns = np.round((reference[index] - value) / turn)
            fewest, most = np.ceil((lower - value) / turn), np.floor((upper - value) / turn)
            if fewest <= most:
                value = value + turn * np.clip(turns, fewest, most)
            else:
                middle = 0.5 * (lower + upper)
                value = value + turn * np.round((middle - value) / turn)
        excess = max(lower - value, value - upper)
        if excess > 0 and (worst is None or excess > worst[0]):
            limit = space.lower[index] if value < lower else space.upper[index]
            worst = (float(excess), index, float(limit))
        turned[index] = value
    if worst is not None:
        _, index, limit = worst
        return LimitedSolution(turned, space.joint_names[index], float(turned[index]), limit)
    return np.clip(turned, space.lower, space.upper)


def meets_tolerance(goal: LinkGoal, pose: SE3) -> bool:
    """Whether a link pose is within the goal's tolerances."""
    if isinstance(goal, PoseGoal):
        shift, angle = goal.pose.distance_to(pose)
        if shift > goal.position_tolerance:
            return False
        if goal.axis_tolerances is None:
            return angle <= goal.orientation_tolerance
        turn = turn_from(goal.pose.rotation, pose.rotation, goal.axis_tolerances)
        return is_within(turn, goal.axis_tolerances)
    shift = float(np.linalg.norm(goal.position - pose.translation))
    if shift > goal.position_tolerance:
        return False
    if goal.pitch is None:
        return True
    down = -pose.rotation[2, 0]
    off = abs(np.arcsin(np.clip(down, -1, 1)) - np.arcsin(np.sin(goal.pitch)))
    return bool(off <= goal.pitch_tolerance)
