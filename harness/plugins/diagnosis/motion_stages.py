"""The later stages of an explanation: start state, path, time parameterisation."""

from __future__ import annotations

import numpy as np

from harness.core.quantity import distinct
from harness.core.types import FloatArray
from harness.planning.collision.checker import touch_records
from harness.planning.collision.scene import CoalScene
from harness.planning.collision.wording import (
    angle,
    counted_noun,
    length_text,
    touch,
    touches,
)
from harness.planning.verification.verify import FINAL_RESOLUTION
from harness.plugins.diagnosis.stage_request import StageFinding, StageRequest
from harness.ports.scene import Touch
from harness.recording.explanation import NearestState, Stage
from harness.recording.goal_failures import CollisionFailure
from harness.recording.motion_failures import (
    AdvisedFailure,
    DurationFailure,
    OverloadFailure,
    PathCollision,
    SearchFailure,
    TraceFailure,
    TrajectoryFailure,
)

RESOLUTION = FINAL_RESOLUTION
"""Joint-space distance between checked states of a straight path [rad]."""

_GOAL_CODES = (
    "NO_IK_SOLUTION",
    "GOAL_IN_COLLISION",
    "GOAL_CONSTRAINTS_VIOLATED",
    "GOAL_STATE_INVALID",
)
_TIMING_DEFECTS = (
    "timing",
    "velocity limit",
    "acceleration limit",
    "effort limit",
    "standing effort",
    "jerk limit",
    "stamps",
)


def start_finding(request: StageRequest) -> StageFinding:
    """Whether the motion can begin at the robot's current state."""
    failure = request.failure
    if failure.code == "START_STATE_INVALID":
        stage = Stage("start state", "failed", failure.message, failure.code)
        return StageFinding(stage, advice="start inside the limits: `robot: {start_state: ...}`")
    found = request.scene.distances(request.start)
    if request.checker is not None:
        to_objects = [item for item, keeps_padding in found if keeps_padding]
        nearest = (to_objects or [item for item, _ in found])[:1]
        clause = f"; nearest are {touch(nearest[0])}" if nearest else ""
        return StageFinding(Stage("start state", "passed", f"free{clause}"))
    deep = [item for item, _ in found if item.distance < 0]
    first, second = deep[0].first, deep[0].second
    stage = Stage(
        "start state",
        "failed",
        f"in collision before anything moves: {counted_noun(deep, 'pair')}",
        "START_STATE_IN_COLLISION",
        tuple(map(touch, deep)),
    )
    state = NearestState(
        "start state in collision",
        request.joints(request.space.part(request.start)),
        touches=touch_records(deep),
    )
    advice = (
        f"{way_out(deep[0], request.scene)}, or start elsewhere (`robot: {{start_state: ...}}`); "
        "where the contact is intended, plan inside `allow_collisions` with the pair "
        f"[{first}, {second}]"
    )
    return StageFinding(stage, state, advice)


def path_finding(request: StageRequest, target: FloatArray | None) -> StageFinding:
    """What blocks the path; `target` are the group positions of the first free solution."""
    failure = request.failure
    if failure.code.startswith("START_STATE"):
        return StageFinding(Stage("path", "skipped", "there is no start to go from"))
    if is_timing(request):
        return StageFinding(Stage("path", "passed", "found"))
    traced = failure.details.find(TraceFailure)
    if failure.code in _GOAL_CODES and (traced is None or traced.free_share is None):
        return StageFinding(Stage("path", "skipped", "there is no goal to go to"))
    details, nearest = _blocked(request, target)
    stage = Stage("path", "failed", failure.message, failure.code, tuple(details))
    return StageFinding(stage, nearest, _path_advice(request, nearest))


def timing_finding(request: StageRequest) -> StageFinding:
    """Whether a path can be timed under the limits."""
    failure = request.failure
    if not is_timing(request):
        return StageFinding(Stage("time parameterisation", "skipped", "there is no path"))
    advice = "lower the scaling factors in `planning`"
    overload = failure.details.find(OverloadFailure)
    too_short = failure.details.find(DurationFailure)
    if overload is not None:
        advice = _overload_advice(overload)
    elif too_short is not None:
        advice = f"give it `duration: {too_short.shortest_duration:.3f}` or more"
    stage = Stage("time parameterisation", "failed", failure.message, failure.code)
    return StageFinding(stage, advice=advice)


def _overload_advice(overload: OverloadFailure) -> str:
    """Advice for an arm that cannot hold itself or its payload statically."""
    most = overload.most_mass or 0.0
    if most >= 0.01:
        held = " and ".join(overload.held or ())
        mass = np.floor(100 * most) / 100
        return (
            f"no slower motion helps: give {held} a `mass` of at most {mass:g} kg, hold it nearer"
            " to the robot's base, or use a stronger arm"
        )
    return (
        "no slower motion helps: keep the arm nearer to its base, or compare the robot's effort"
        " limits and masses with its data sheet (`harness robot check` prints them) and correct the"
        " `effort` of a joint's <limit>, or `joints: {JOINT: {max_effort: ...}}` of a robot.yaml"
    )


def is_timing(request: StageRequest) -> bool:
    """Whether the failure occurred in time parameterisation."""
    details = request.failure.details
    broken = details.find(TrajectoryFailure)
    is_defect = broken is not None and broken.broken in _TIMING_DEFECTS
    return is_defect or details.find(DurationFailure) is not None


def _blocked(
    request: StageRequest, target: FloatArray | None
) -> tuple[list[str], NearestState | None]:
    """Details of a blocked motion, and a state to draw: its end, or the first blocked state."""
    failure, options = request.failure.details, request.options
    details: list[str] = []
    shown: NearestState | None = None
    traced = failure.find(TraceFailure) or failure.find(PathCollision)
    if traced is not None and traced.joint_positions is not None:
        joints = request.joints(np.array(traced.joint_positions))
        shown = NearestState("as far as it goes", joints, touches=traced.touches or ())
    elif _advised(request) is None and request.checker is not None and target is not None:
        start = request.space.part(request.start)
        straight = np.array([start, target])
        blocked = request.checker.first_block(straight, RESOLUTION)
        if blocked is not None:
            share, state, found = blocked
            details.append(
                f"what blocks: after {100 * share:.0f} % of the direct joint motion,"
                f" {touches(found)}"
            )
            shown = NearestState(
                "where the direct joint motion is blocked",
                request.joints(state),
                touches=touch_records(found),
            )
    search = failure.find(SearchFailure)
    if search is not None and search.gap is not None:
        details.append(
            f"gap between the search trees: {angle(search.gap)} of joint space remain between "
            "the states reached from the start and the goal"
        )
    if search is not None:
        searches = counted_noun(options.attempts, "search")
        details.append(
            f"budget: {search.state_checks} state checks used in {searches} of "
            f"{options.max_state_checks}"
        )
    return details, shown


def _advised(request: StageRequest) -> AdvisedFailure | None:
    """What failed apart from obstacles: the motion's own geometry, or a plug-in."""
    details = request.failure.details
    return None if details.find(SearchFailure) is not None else details.find(AdvisedFailure)


def _path_advice(request: StageRequest, shown: NearestState | None) -> str:
    """Advice for a path that was not found, with the state that is drawn."""
    failure = request.failure
    advised = _advised(request)
    if advised is not None:
        return advised.advice
    if failure.code == "PLANNING_FAILED" and failure.details.find(SearchFailure) is not None:
        return (
            "raise `max_state_checks` or `planning_attempts` in `planning`, put a `move_to` in "
            "between that leads around, or try another `planner_id` (`harness bench` compares them)"
        )
    traced, collision = failure.details.find(TraceFailure), failure.details.find(CollisionFailure)
    shows_touches = (part for part in (traced, collision, shown) if part is not None)
    distances = [touch.distance for part in shows_touches for touch in part.touches or ()]
    if distances and min(distances) >= 0:
        return padding_advice(min(distances), request.options.padding)
    if distances:
        return "`move_to` goes around what is in the way; or put a step in between that leads past"
    if traced is not None and traced.reason in ("unreachable", "limit", "jump"):
        return (
            "begin the line in another posture (a `move_to` with `joints` before it), make it "
            "shorter, or use `move_to`, which need not keep to the line"
        )
    return ""


def padding_advice(distance: float, padding: float) -> str:
    """What to do where the padding alone is in the way."""
    smaller, stated = distinct(distance, padding, length_text)
    return (
        f"nothing touches, only the `padding` of {stated} is not kept: give `planning` a `padding`"
        f" of less than {smaller}"
    )


def way_out(item: Touch, scene: CoalScene) -> str:
    """What to change so that the robot, or what it holds, comes apart from the body it is in."""
    objects = set(scene.object_names()) - set(scene.attached())
    blocker = next((name for name in (item.second, item.first) if name in objects), None)
    if blocker is None:
        return "move the joints so that the links come apart"
    if scene.is_ground(blocker):
        depth = length_text(-item.distance)
        return f"raise the robot's `base`: it reaches {depth} into '{blocker}'"
    return f"move '{blocker}' out of the way: it is {length_text(-item.distance)} too near"
