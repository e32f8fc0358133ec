"""Kinematics of a composed robot, with an analytic inverse where one exists, else a numeric one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from harness.core.errors import PlanningFailed
from harness.core.kinematics import LinkPoses
from harness.core.registry import registry
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.planning.ik.answer import IkAnswer, LimitedSolution
from harness.planning.ik.nearest_pose import NearestPose, distance_to_goal
from harness.planning.ik.numeric import LinkGoal, LinkTask
from harness.planning.ik.task import task_of
from harness.planning.ik.third_party import solve_with_third_party
from harness.planning.model.robot_model import GroupSpace, RobotModel
from harness.planning.model.turns import is_within, turns_from
from harness.ports.goals import PoseGoal, PositionGoal
from harness.ports.kinematics import IkRequest, IkSolver
from harness.recording.goal_failures import LinkFailure
from harness.robot.description import RobotDescription

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
        poses = LinkPoses(self.description.joints, joint_positions, links)
        return np.stack([poses.rows(link) for link in links], axis=1)

    def solve(
        self,
        group: str,
        goal: PoseGoal | PositionGoal,
        seed_positions: FloatArray,
        seed: int,
        *,
        enough: int | None = None,
    ) -> Sequence[FloatArray]:
        """Every known solution within position limits, nearest to `seed_positions` first."""
        space = GroupSpace(self.robot, group, seed_positions)
        return self.analyse(space, goal, seed_positions, seed, enough=enough).solutions

    def analyse(
        self,
        space: GroupSpace,
        goal: LinkGoal,
        seed_positions: FloatArray,
        seed: int,
        *,
        enough: int | None = None,
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
        request = self.request(space, goal, seed_positions, seed, enough=enough)
        solver = self._solver(request)
        is_own = registry(IkSolver.plugin_kind).is_own(solver.name)
        result = solver().solve(request) if is_own else solve_with_third_party(solver, request)
        refused: list[NearestPose] = []
        solutions = result.solutions
        if not is_own:
            solutions = _reaching(space, request, solutions, refused)
        inside, outside, missed = self._sort(
            space, goal, solutions, reference, polish=solver.is_refined
        )
        return IkAnswer(
            tuple(inside),
            tuple(outside),
            result.excess,
            solver.name,
            task_of(space.task_space, goal),
            tuple(missed),
            tuple(refused),
        )

    def request(
        self,
        space: GroupSpace,
        goal: LinkGoal,
        seed_positions: FloatArray,
        seed: int,
        *,
        enough: int | None = None,
    ) -> IkRequest:
        """What a solver is given for a goal; `seed_positions` in description order."""
        return IkRequest(
            goal,
            space,
            space.part(seed_positions),
            self.description,
            lambda positions: self.link_pose(space.whole(positions), goal.link),
            seed,
            enough,
        )

    def _solver(self, request: IkRequest) -> type[IkSolver]:
        """The robot's solver, or the numeric one where that is not made for the request."""
        solvers = registry(IkSolver.plugin_kind)
        chosen = self.description.ik_solver
        tried: list[type[IkSolver]] = [] if chosen == "auto" else [solvers[chosen]]
        if chosen == "auto":
            tried += [each for each in solvers.built_in() if each.is_closed_form]
        return next((each for each in tried if each.fits(request)), solvers["numeric"])

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
    ) -> tuple[list[FloatArray], list[LimitedSolution], list[NearestPose]]:
        """Refine candidates, turn them into the limits, and sort them: inside, outside, missed."""
        task = LinkTask(space, goal)
        inside: list[FloatArray] = []
        outside: list[LimitedSolution] = []
        missed: list[NearestPose] = []
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
    ) -> list[NearestPose]:
        """The candidate as a missed solution if it reaches the position inside the limits."""
        kept = into_limits(space, positions, reference)
        shift, turn = distance_to_goal(goal, pose)
        at_the_point = isinstance(goal, PoseGoal) and shift <= goal.position_tolerance
        if isinstance(kept, LimitedSolution) or not at_the_point:
            return []
        return [NearestPose(kept, pose, shift, turn)]

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


def _reaching(
    space: GroupSpace,
    request: IkRequest,
    solutions: Sequence[FloatArray],
    refused: list[NearestPose],
) -> list[FloatArray]:
    """Solutions that reach the goal, or the part of it that the arm can choose."""
    kept: list[FloatArray] = []
    for positions in solutions:
        pose = request.link_pose(positions)
        shift, turn = distance_to_goal(request.goal, pose)
        at_the_point = shift <= request.goal.position_tolerance
        is_part = isinstance(request.goal, PoseGoal) and not space.task_space.holds_pose
        if meets_tolerance(request.goal, pose) or (is_part and at_the_point):
            kept.append(positions)
        else:
            refused.append(NearestPose(positions, pose, shift, turn))
    refused.sort(key=lambda one: (round(one.shift + one.turn, 9), tuple(one.positions)))
    return kept


def into_limits(
    space: GroupSpace, positions: FloatArray, reference: FloatArray
) -> FloatArray | LimitedSolution:
    """Shift a solution by whole turns into the limits, nearest to a reference."""
    turn, lower, upper = 2 * np.pi, space.lower - _LIMIT_SLACK, space.upper + _LIMIT_SLACK
    fewest, most = np.ceil((lower - positions) / turn), np.floor((upper - positions) / turn)
    turns = np.clip(np.round((reference - positions) / turn), fewest, most)
    apart = fewest > most  # no turn brings the joint inside
    middle = 0.5 * (lower[apart] + upper[apart])
    turns[apart] = np.round((middle - positions[apart]) / turn)
    turned: FloatArray = positions + turn * turns * space.wraps
    excess = np.maximum(lower - turned, turned - upper)
    worst = int(excess.argmax())
    if excess[worst] <= 0:
        return np.clip(turned, space.lower, space.upper)
    is_below = turned[worst] < lower[worst]
    limit = space.lower[worst] if is_below else space.upper[worst]
    name = space.joint_names[worst]
    return LimitedSolution(turned, name, float(turned[worst]), float(limit))


def meets_tolerance(goal: LinkGoal, pose: SE3) -> bool:
    """Whether a link pose is within the goal's tolerances."""
    shift, turn = distance_to_goal(goal, pose)
    if shift > goal.position_tolerance:
        return False
    if isinstance(goal, PositionGoal):
        return goal.pitch is None or turn <= goal.pitch_tolerance
    if goal.axis_tolerances is None:
        return turn <= goal.orientation_tolerance
    turns = turns_from(goal.pose.rotation, pose.rotation[None], goal.axis_tolerances)
    return is_within(turns[0], goal.axis_tolerances)
