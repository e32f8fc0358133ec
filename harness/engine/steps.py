"""What a step says, checked against the robot and the scene at its place in the file."""

from __future__ import annotations

from harness.core.registry import Registry
from harness.engine.blends import check_blends
from harness.engine.goals import arm_has_six_joints
from harness.engine.grasping import GAP_SLACK
from harness.engine.program import Loc
from harness.engine.scope import Scope
from harness.spec.goals import GoalFields
from harness.spec.planning import PathConstraints
from harness.spec.poses import Pose
from harness.spec.steps import (
    AddObject,
    AllowCollisions,
    AnyStep,
    ArcFields,
    AttachObject,
    Capture,
    CartesianPath,
    Circ,
    ClearObjects,
    DetachObject,
    Grasp,
    Gripper,
    Inject,
    Lin,
    MoveObject,
    MoveRelative,
    MoveTo,
    Parallel,
    Pick,
    Place,
    Ptp,
    Release,
    RemoveObject,
    Sequence,
    Travel,
    Wait,
)

ARM_MOTIONS = frozenset(
    {"move_to", "ptp", "lin", "circ", "move_relative", "cartesian_path", "sequence"}
)
SPECIAL_BODIES = ("robot",)


class At:
    """A scope and the place of the step in it."""

    def __init__(self, scope: Scope, loc: Loc) -> None:
        self.scope = scope
        self.loc = loc

    def key(self, *keys: str | int) -> Loc:
        """Place of something inside the step."""
        return (*self.loc, *keys)


check: Registry[At, None] = Registry()


def check_step(step: AnyStep, loc: Loc, scope: Scope) -> None:
    """Report what is wrong with a step, then let the scope know what it changes."""
    at = At(scope, loc)
    if step.group is not None:
        scope.check_group(step.group, at.key("group"))
    if type(step) in check:
        check(step, at)


def _check_pose(pose: Pose, at: At, *keys: str | int) -> None:
    at.scope.check_frame(pose.frame, at.key(*keys, "frame"))


def _check_goal(goal: GoalFields, group_name: str | None, at: At) -> None:
    scope = at.scope
    group = scope.check_group(group_name, at.key("group"))
    if goal.named_target is not None:
        scope.check_state(group, goal.named_target, at.key("named_target"))
    for name in goal.joints or {}:
        scope.check_joint(name, at.key("joints", name), group)
    if goal.pose is not None:
        _check_pose(goal.pose, at, "pose")
    if goal.position is not None:
        scope.check_frame(goal.position.frame, at.key("position", "frame"))
    scope.check_link_or_held(goal.link, at.key("link"))
    description = scope.description
    has_no_tip = group in description.groups and not description.groups[group].tip_link
    if (goal.pose or goal.position) and has_no_tip:
        scope.problems.add(
            at.loc, f"the group '{group}' is no chain, so it has no link to send to a pose"
        )


@check.handles(MoveTo)
def _move_to(step: MoveTo, at: At) -> None:
    _check_goal(step, step.group, at)
    for index, goal in enumerate(step.any_of or ()):
        _check_goal(goal, step.group, At(at.scope, at.key("any_of", index)))
    if step.path_constraints is not None:
        _check_constraints(step.path_constraints, step.group, at)


def _check_constraints(constraints: PathConstraints, group_name: str | None, at: At) -> None:
    scope = at.scope
    band, box = constraints.orientation, constraints.position
    if band is not None:
        scope.check_link(band.link, at.key("path_constraints", "orientation", "link"))
        _check_pose(band.pose, at, "path_constraints", "orientation", "pose")
    if box is not None:
        scope.check_link(box.link, at.key("path_constraints", "position", "link"))
        frame = at.key("path_constraints", "position", "center", "frame")
        scope.check_frame(box.center.frame, frame)
    group = scope.check_group(group_name, at.key("group"))
    for name in constraints.joints or {}:
        scope.check_joint(name, at.key("path_constraints", "joints", name), group)


@check.handles(Ptp)
def _ptp(step: Ptp, at: At) -> None:
    _check_goal(step, step.group, at)
    if step.duration is not None:
        at.scope.take_time(step.duration, at.key("duration"))
        if not (step.joints or step.named_target):
            at.scope.problems.add(
                at.key("duration"), "`duration` goes with `joints` or a named state"
            )


@check.handles(Capture)
def _capture(step: Capture, at: At) -> None:
    at.scope.check_camera(step.camera, at.key("camera"))


@check.handles(Wait)
def _wait(step: Wait, at: At) -> None:
    at.scope.take_time(step.duration, at.key("duration"))


@check.handles(Lin)
def _lin(step: Lin, at: At) -> None:
    _check_goal(step, step.group, at)


@check.handles(Circ)
def _circ(step: Circ, at: At) -> None:
    _check_goal(step, step.group, at)
    _check_arc(step, at)


def _check_arc(arc: ArcFields, at: At) -> None:
    for key in ("interim", "center"):
        point = getattr(arc, key)
        if point is not None:
            at.scope.check_frame(point.frame, at.key(key, "frame"))


@check.handles(CartesianPath)
def _cartesian_path(step: CartesianPath, at: At) -> None:
    at.scope.check_group(step.group, at.key("group"))
    at.scope.check_link_or_held(step.link, at.key("link"))
    for index, waypoint in enumerate(step.waypoints):
        _check_pose(waypoint, at, "waypoints", index)


@check.handles(Sequence)
def _sequence(step: Sequence, at: At) -> None:
    group = at.scope.check_group(step.group, at.key("group"))
    for index, item in enumerate(step.items):
        for kind in ("ptp", "lin", "circ"):
            motion = getattr(item, kind)
            if motion is not None:
                inside = At(at.scope, at.key("items", index, kind))
                _check_goal(motion, step.group, inside)
                if isinstance(motion, ArcFields):
                    _check_arc(motion, inside)
    check_blends(step, group, at.loc, at.scope)


@check.handles(MoveRelative)
def _move_relative(step: MoveRelative, at: At) -> None:
    at.scope.check_group(step.group, at.key("group"))
    at.scope.check_link(step.link, at.key("link"))
    for key in ("direction", "rotation"):
        direction = getattr(step, key)
        if direction is not None:
            at.scope.check_frame(direction.frame, at.key(key, "frame"))


@check.handles(Gripper)
def _gripper(step: Gripper, at: At) -> None:
    if not at.scope.check_gripper(at.loc, "`gripper`"):
        return
    hand = at.scope.description.gripper
    if hand is not None and step.named_target is not None:
        at.scope.check_state(hand.group, step.named_target, at.key("named_target"))
    _check_gripper_position(step.position, at)
    _check_gripper_width(step.width, at)


@check.handles(Grasp)
def _grasp(step: Grasp, at: At) -> None:
    if at.scope.check_gripper(at.loc, "`grasp`"):
        _check_gripper_position(step.position, at)
    _check_graspable(step.object, at)
    at.scope.attached[step.object] = None


@check.handles(Release)
def _release(step: Release, at: At) -> None:
    scope = at.scope
    hand = scope.description.gripper
    if scope.check_gripper(at.loc, "`release`") and hand and step.named_target:
        scope.check_state(hand.group, step.named_target, at.key("named_target"))
    if step.object is not None:
        scope.check_object(step.object, at.key("object"))
        scope.attached.pop(step.object, None)
    elif scope.attached:
        scope.attached.popitem()


def _check_gripper_position(position: float | None, at: At) -> None:
    hand = at.scope.description.gripper
    if position is None or hand is None:
        return
    joint = at.scope.description.joint_by_name[hand.joint]
    if not joint.lower <= position <= joint.upper:
        at.scope.problems.add(
            at.key("position"),
            f"'{joint.name}' goes from {joint.lower:g} to {joint.upper:g}, not to {position:g}",
        )


def _check_gripper_width(width: float | None, at: At) -> None:
    hand = at.scope.description.gripper
    if width is None or hand is None:
        return
    narrowest, widest = hand.widths[:, 1].min(), hand.widths[:, 1].max()
    if not narrowest - GAP_SLACK <= width <= widest + GAP_SLACK:
        at.scope.problems.add(
            at.key("width"),
            f"the gap between the pads goes from {1e3 * narrowest:.1f} to {1e3 * widest:.1f} mm,"
            f" not to {1e3 * width:.1f} mm",
        )


def _check_graspable(name: str, at: At) -> None:
    scope = at.scope
    scope.check_present(name, at.key("object"))
    obj = scope.objects.get(name)
    if obj is not None:
        scope.check_object(name, at.key("object"), simulated=True)
    if obj is not None and obj.is_static:
        scope.problems.add(at.key("object"), f"'{name}' is static: it cannot be picked up")
    if obj is not None and not obj.in_planning:
        scope.problems.add(
            at.key("object"),
            f"'{name}' is unknown to the planner, so it cannot be attached",
            "name an object that is `in: both`",
        )


@check.handles(AttachObject)
def _attach(step: AttachObject, at: At) -> None:
    scope = at.scope
    if isinstance(step.object, str):
        name = step.object
        scope.check_present(name, at.key("object"))
    else:
        name = step.object.name
        _check_pose(step.object.pose, at, "object", "pose")
        scope.present[name] = None
        scope.added[name] = None
    scope.check_link(step.link, at.key("link"))
    for index, link in enumerate(step.touch_links or ()):
        scope.check_link(link, at.key("touch_links", index))
    if step.represents is not None:
        scope.check_object(step.represents, at.key("represents"), simulated=True)
    scope.attached[name] = None


@check.handles(DetachObject)
def _detach(step: DetachObject, at: At) -> None:
    at.scope.check_object(step.object, at.key("object"))
    if step.object in at.scope.objects and step.object not in at.scope.attached:
        at.scope.problems.add(at.key("object"), f"'{step.object}' is not attached at this step")
    at.scope.attached.pop(step.object, None)


@check.handles(AddObject)
def _add(step: AddObject, at: At) -> None:
    for index, spec in enumerate(step.objects):
        _check_pose(spec.pose, at, "objects", index, "pose")
        if spec.name in at.scope.present:
            at.scope.problems.add(
                at.key("objects", index, "name"), f"'{spec.name}' is in the scene already"
            )
        at.scope.present[spec.name] = None
        at.scope.added[spec.name] = None


@check.handles(RemoveObject)
def _remove(step: RemoveObject, at: At) -> None:
    for index, name in enumerate(step.objects):
        at.scope.check_present(name, at.key("objects", index))
        at.scope.present.pop(name, None)
        at.scope.added.pop(name, None)


@check.handles(MoveObject)
def _move_object(step: MoveObject, at: At) -> None:
    at.scope.check_present(step.object, at.key("object"))
    _check_pose(step.pose, at, "pose")


@check.handles(ClearObjects)
def _clear(step: ClearObjects, at: At) -> None:
    scope = at.scope
    going = list(scope.present) if step.world else list(scope.added)
    for name in going:
        if name not in scope.attached:
            scope.present.pop(name, None)
            scope.added.pop(name, None)


@check.handles(AllowCollisions)
def _allow(step: AllowCollisions, at: At) -> None:
    for index, pair in enumerate(step.pairs):
        for side, name in enumerate(pair):
            at.scope.check_body(name, at.key("pairs", index, side), special=SPECIAL_BODIES)


@check.handles(Pick)
def _pick(step: Pick, at: At) -> None:
    at.scope.check_gripper(at.loc, "`pick`")
    _check_graspable(step.object, at)
    if step.grasp_pose is not None:
        _check_pose(step.grasp_pose, at, "grasp_pose")
    group = at.scope.check_group(step.group, at.key("group"))
    known = group in at.scope.description.groups
    if step.pitch is not None and known and arm_has_six_joints(at.scope.description, group):
        at.scope.problems.add(
            at.key("pitch"),
            "`pitch` is for arms of fewer than six joints, and this one reaches any rotation",
            "give a `grasp_pose` with a rotation: `rpy`, `quat_xyzw` or `quat_wxyz`",
        )
    _check_travel(step.approach, at, "approach")
    _check_travel(step.lift, at, "lift")
    at.scope.attached[step.object] = None


@check.handles(Place)
def _place(step: Place, at: At) -> None:
    at.scope.check_gripper(at.loc, "`place`")
    _check_pose(step.pose, at, "pose")
    if step.object is not None:
        at.scope.check_object(step.object, at.key("object"))
    _check_travel(step.approach, at, "approach")
    _check_travel(step.retreat, at, "retreat")
    name = step.object or next(reversed(at.scope.attached), None)
    if name is not None:
        at.scope.attached.pop(name, None)


def _check_travel(travel: Travel | None, at: At, key: str) -> None:
    if travel is not None and travel.direction is not None:
        at.scope.check_frame(travel.direction.frame, at.key(key, "direction", "frame"))


@check.handles(Inject)
def _inject(step: Inject, at: At) -> None:
    scope = at.scope
    for name in step.friction or {}:
        scope.check_object(name, at.key("friction", name), simulated=True, is_key=True)
    for name in step.push or {}:
        loc = at.key("push", name)
        scope.check_object(name, loc, simulated=True, is_key=True)
        if name in scope.objects:
            scope.check_present(name, loc)
            if scope.objects[name].is_static:
                scope.problems.add(loc, f"'{name}' is static: no push moves it")
    if step.push is not None:
        scope.take_time(step.push_duration * len(step.push), at.key("push_duration"))
    if step.gripper_effort is not None:
        scope.check_gripper(at.key("gripper_effort"), "`gripper_effort`")
    _check_stall(step.joint_stall, at)


def _check_stall(name: str | None, at: At) -> None:
    if name is None:
        return
    description = at.scope.description
    joint = description.joint_by_name.get(name)
    if joint is None:
        at.scope.problems.unknown(at.key("joint_stall"), "joint", name, description.joint_names)
    elif joint.mimic is not None:
        at.scope.problems.add(
            at.key("joint_stall"),
            f"'{name}' follows '{joint.mimic.joint}'",
            f"stall '{joint.mimic.joint}'",
        )


@check.handles(Parallel)
def _parallel(step: Parallel, at: At) -> None:
    verbs = [child.do for child in step.steps]
    if len(verbs) != 2 or verbs.count("gripper") != 1 or not set(verbs) & ARM_MOTIONS:
        at.scope.problems.add(
            at.key("steps"),
            "`parallel` is one motion of the arm and one `gripper` step",
            "arm motions: " + ", ".join(sorted(ARM_MOTIONS)),
        )
    for index, child in enumerate(step.steps):
        if child.expect_error is not None:
            at.scope.problems.add(
                at.key("steps", index, "expect_error"),
                "a step of `parallel` cannot be expected to fail",
                "say `expect_error` of the `parallel` step",
            )
