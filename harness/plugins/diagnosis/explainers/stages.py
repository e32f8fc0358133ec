"""Explains a failed planning call: the result of each planning stage, in order."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import ClassVar

import numpy as np

from harness.cell.cell import Cell
from harness.core.errors import PlanningFailed, StepFailed
from harness.core.types import FloatArray
from harness.planning.collision.checker import MotionChecker, touch_records
from harness.planning.collision.scene import CoalScene
from harness.planning.collision.wording import counted_noun, joint_value, touches
from harness.planning.diagnosis import Explainer
from harness.planning.goals.goal_study import broken_limits, limit_sentence, study_goal
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.planning.model.robot_model import GroupSpace
from harness.plugins.diagnosis.advice import advice
from harness.plugins.diagnosis.branch_stage import branches_finding
from harness.plugins.diagnosis.mesh_note import mesh_note
from harness.plugins.diagnosis.motion_stages import path_finding, start_finding, timing_finding
from harness.plugins.diagnosis.reach_stage import reach_finding
from harness.plugins.diagnosis.stage_request import StageFinding, StageRequest
from harness.ports.goals import AnyGoal, JointGoal
from harness.ports.motion_planning import MotionRequest
from harness.recording.explanation import Explanation, NearestState, Stage


def goal_findings(request: StageRequest) -> tuple[list[StageFinding], FloatArray | None]:
    """Explain reach and inverse kinematics, and the group positions of the first free solution.

    Nothing where the motion has no goal of its own.
    """
    goal = request.goal
    if goal is None:
        return [], None
    if isinstance(goal, JointGoal):
        positions = np.asarray(goal.positions, dtype=float)
        return _joint_findings(request, positions), positions
    space, start, seed = request.space, request.start, request.options.seed
    study = study_goal(request.kinematics, space, request.touches, start, goal, seed)
    free = (branch.positions for branch in study.branches if not branch.touches)
    findings = [reach_finding(request, goal, study), branches_finding(request, goal, study)]
    return findings, next(free, None)


def _joint_findings(request: StageRequest, positions: FloatArray) -> list[StageFinding]:
    space = request.space
    broken = broken_limits(space, positions)
    given = "not needed: the goal gives joint positions"
    if broken:
        first = broken[0]
        below = first.value < first.lower
        limit = joint_value(space, first.joint, first.lower if below else first.upper)
        stage = Stage(
            "reach",
            "failed",
            f"{counted_noun(broken, 'joint')} beyond a limit",
            "GOAL_STATE_INVALID",
            tuple(limit_sentence(space, each) for each in broken),
        )
        nearest = NearestState(
            "nearest joint positions inside the limits",
            request.joints(np.clip(positions, space.lower, space.upper)),
        )
        advice = f"give {first.joint} at {'least' if below else 'most'} {limit}"
        unknown = Stage("inverse kinematics", "skipped", given)
        return [StageFinding(stage, nearest, advice), StageFinding(unknown)]
    reach = StageFinding(Stage("reach", "passed", "every joint is inside its limits"))
    found = request.touches(positions)
    if not found:
        return [
            reach,
            StageFinding(Stage("inverse kinematics", "passed", f"{given}, and they are free")),
        ]
    stage = Stage(
        "inverse kinematics",
        "failed",
        f"{given}; there {touches(found)}",
        "GOAL_IN_COLLISION",
    )
    nearest = NearestState(
        "goal in collision", request.joints(positions), touches=touch_records(found)
    )
    advice = f"choose other joint positions, which keep away from {found[0].second}"
    return [reach, StageFinding(stage, nearest, advice)]


class Stages(Explainer):
    """The result of each planning stage: reach, inverse kinematics, start, path and timing."""

    name: ClassVar[str] = "stages"

    def advice(self, failure: StepFailed, cell: Cell) -> str:
        return advice(failure, cell)

    def explain(
        self,
        failure: PlanningFailed,
        request: MotionRequest,
        scene: CoalScene,
        kinematics: PinocchioKinematics,
    ) -> Explanation:
        """Explain a failed call; a choice of several goals is explained by what it raised."""
        start = np.asarray(request.start, dtype=float)
        space, checker = GroupSpace(kinematics.robot, request.group, start), None
        with suppress(PlanningFailed):  # where no motion can begin from the start state
            checker = MotionChecker(scene, space, space.part(start), request.options.padding)
        goal = None if isinstance(request.goal, AnyGoal) else request.goal
        return explanation_of(
            StageRequest(failure, kinematics, scene, space, start, goal, request.options, checker)
        )


def explanation_of(request: StageRequest) -> Explanation:
    """Explain a failed call.

    `stages` follow the order of `recording.explanation.STAGES`. `nearest` is a robot state to draw
    and `advice` is what to do; both belong to the first stage that has them. A start that no
    motion can leave comes before the goal: no other goal helps.
    """
    findings, target = goal_findings(request)
    start = start_finding(request)
    findings += [start, path_finding(request, target), timing_finding(request)]
    stages = tuple(finding.stage for finding in findings)
    if request.failure.code.startswith("START_STATE"):
        findings.insert(0, start)
    nearest = next((finding.nearest for finding in findings if finding.nearest), None)
    advice = next((finding.advice for finding in findings if finding.advice), None)
    touches = (nearest and nearest.touches) or ()
    if note := mesh_note(touches, request.options.padding, request.scene):
        failed = next((stage for stage in stages if stage.status == "failed"), None)
        stages = tuple(
            replace(stage, details=(*stage.details, note)) if stage is failed else stage
            for stage in stages
        )
    return Explanation(stages, nearest, advice)
