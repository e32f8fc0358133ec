"""Which joint positions put the TCP at a pose, and what forbids each of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.errors import PlanningFailed
from harness.core.spatial import SE3, pitch_of
from harness.core.types import FloatArray
from harness.planning.collision.checker import MotionChecker
from harness.planning.collision.wording import touches as touches_text
from harness.planning.goals.goal_study import study_goal
from harness.planning.goals.goals import find_goals
from harness.planning.ik.answer import IkAnswer
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.planning.ik.nearest_pose import nearest_pose
from harness.planning.model.robot_model import GroupSpace
from harness.plugins.studio.live_cell import LiveCell
from harness.ports.goals import PoseGoal, PositionGoal
from harness.ports.scene import Touch


@dataclass(frozen=True, eq=False)
class Way:
    """Joint positions that reach a pose.

    Attributes:
        positions: The positions of all joints, in description order.
        name: The posture of the arm; empty where the solver has no branches.
        refusal: Why they cannot be taken; empty where they are free.
    """

    positions: FloatArray
    name: str
    refusal: str


@dataclass(frozen=True, eq=False)
class Reach:
    """The answer to a dragged pose.

    Attributes:
        ways: Joint positions inside the limits, nearest to where the arm stands first.
        refusal: Why the pose cannot be reached at all; empty where a way is free.
        nearest: Joint positions nearest to a pose that no way reaches, where it was explained.
    """

    ways: tuple[Way, ...]
    refusal: str
    nearest: FloatArray | None = None

    @property
    def best(self) -> Way | None:
        """The nearest free way."""
        return next((way for way in self.ways if not way.refusal), None)


def way_names(cell: LiveCell, ways: Sequence[Way]) -> list[str]:
    """A name for each way that no other has: its posture, and where that is not enough a joint.

    The joint is that in which ways of one posture differ most, with its position.
    """
    names = [way.name or f"way {number}" for number, way in enumerate(ways, 1)]
    joints = cell.description.movable_joints
    for name in {each for each in names if names.count(each) > 1}:
        same = [index for index, each in enumerate(names) if each == name]
        positions = np.array([ways[index].positions for index in same])
        widest = int(np.argmax(np.ptp(positions, axis=0)))
        factor, unit = (1e3, " mm") if joints[widest].kind == "prismatic" else (180 / np.pi, "°")
        for index, value in zip(same, positions[:, widest], strict=True):
            names[index] = f"{name}, {joints[widest].name} at {factor * value:.0f}{unit}"
    return names


class ReachStudy:
    """Answers many poses while neither the scene nor the arm's start changes."""

    def __init__(self, cell: LiveCell, group: str) -> None:
        """Look at the scene and at where the arm stands now."""
        cell.cell.sync_scene()
        kinematics = cell.prepared.ports.kinematics
        assert isinstance(kinematics, PinocchioKinematics)
        self._kinematics = kinematics
        self._tcp = cell.description.tcp_link
        self._start = cell.cell.planning_start()
        self._space = GroupSpace(kinematics.robot, group, self._start)
        padding = float(cell.prepared.loaded.scenario.planning.padding or 0.0)
        begin = self._space.part(self._start)
        self._checker = MotionChecker(cell.scene, self._space, begin, padding)

    def goal(self, pose: SE3) -> PoseGoal | PositionGoal:
        """The goal that the arm can choose: a pose, or a position and a pitch."""
        if self._space.task_space.holds_pose:
            return PoseGoal(self._tcp, pose)
        return PositionGoal(self._tcp, pose.translation, pitch_of(pose.rotation))

    def answer(self, pose: SE3, near: FloatArray | None = None, *, explain: bool = True) -> Reach:
        """What a TCP pose needs.

        Args:
            pose: The requested pose T_world_tcp.
            near: Joint positions in description order which the branch should continue; None:
                where the arm stands.
            explain: Whether to look for the nearest pose that can be reached; it takes longer.
        """
        start = self._start if near is None else near
        goal = self.goal(pose)

        def find_touches(positions: FloatArray) -> Sequence[Touch]:
            free = self._checker.state_free(positions)
            return [] if free else self._checker.touches(positions)

        study = study_goal(self._kinematics, self._space, find_touches, start, goal, 0)
        ways = tuple(
            Way(
                self._space.whole(branch.positions),
                branch.name,
                touches_text(branch.touches) if branch.touches else "",
            )
            for branch in study.branches
        )
        if any(not way.refusal for way in ways):
            return Reach(ways, "")
        if ways:
            return Reach(ways, f"each way is in collision; the nearest: {ways[0].refusal}")
        if not explain:
            return Reach(ways, _short_refusal(study.answer))
        try:
            find_goals(self._kinematics, self._checker, start, goal, 0)
        except PlanningFailed as failure:
            nearest = nearest_pose(self._space, goal, self._space.part(start))
            return Reach(ways, failure.message, self._space.whole(nearest.positions))
        return Reach(ways, "")


def _short_refusal(answer: IkAnswer) -> str:
    if answer.excess > 0:
        return f"the pose is {1e3 * answer.excess:.0f} mm out of reach"
    if answer.outside_limits:
        nearest = min(answer.outside_limits, key=lambda each: abs(each.value - each.limit))
        by = abs(nearest.value - nearest.limit)
        return f"{nearest.joint} would be {by:.3f} beyond its limit"
    return "no joint positions reach the pose"
