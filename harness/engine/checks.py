"""What an expectation says, checked against robot, objects and steps."""

from __future__ import annotations

from pydantic import BaseModel

from harness.cell.scope import Scope
from harness.engine.summary import words
from harness.spec.checks import (
    AnyExpectation,
    Between,
    Clearance,
    Collision,
    Formula,
    GripperState,
    In,
    Joints,
    NamedTarget,
    ObjectCheck,
    On,
    Placed,
    Sees,
    Static,
    TcpPath,
    TcpPose,
)
from harness.spec.formula import SIGNALS, signals_of
from harness.spec.formula_parser import parse_formula
from harness.spec.poses import Pose
from harness.spec.source import Loc

SPECIAL = ("robot", "gripper", "any")
GRIPPER_CHECKS = ("grasped", "released", "lifted", "gripper")


def check_expectation(
    spec: AnyExpectation, loc: Loc, scope: Scope, judged: frozenset[type]
) -> None:
    """Report what is wrong with an expectation; names may be of steps and objects further down."""
    if type(spec) not in judged:
        known = words(judged, "check")
        scope.problems.add(
            loc,
            f"the expectation `{spec.check}` is not yet available",
            "available: " + ", ".join(known),
        )
        return
    during = getattr(spec, "during", None)
    if during is not None and during not in scope.step_ids:
        scope.problems.unknown(
            (*loc, "during"), "step with the id", during, scope.step_ids, needs=()
        )
    if loc[0] == "expect" and len(loc) == 2:
        _check_step_is_named(spec, loc, scope)
    for key in ("predicate", "until"):
        inner = getattr(spec, key, None)
        if isinstance(inner, BaseModel):
            check_expectation(inner, (*loc, key), scope, judged)  # pyright: ignore[reportArgumentType]
    _check_names(spec, loc, scope)


def _check_step_is_named(spec: AnyExpectation, loc: Loc, scope: Scope) -> None:
    """Report a path without a curve that is expected of the whole run, which has no goal."""
    parts = (spec, getattr(spec, "predicate", None), getattr(spec, "until", None))
    if any(getattr(part, "during", None) for part in parts):
        return
    if any(isinstance(part, TcpPath) and not part.corners() for part in parts):
        scope.problems.add(
            loc,
            "`tcp_path` without `line` or `arc` is the way of one step from its start to its goal;"
            " this is expected of the whole run",
            "write it under the step's `expect`, or name the step with `during`",
        )


def _check_names(spec: AnyExpectation, loc: Loc, scope: Scope) -> None:
    if spec.check in GRIPPER_CHECKS:
        scope.check_gripper(loc, f"`{spec.check}`")
    match spec:
        case Placed():
            scope.check_object(spec.object, (*loc, "object"), simulated=True)
            if spec.on is not None:
                scope.check_body(spec.on, (*loc, "on"), special=())
        case On():
            scope.check_object(spec.object, (*loc, "object"), simulated=True)
            scope.check_body(spec.support, (*loc, "support"), special=())
        case In():
            scope.check_object(spec.object, (*loc, "object"), simulated=True)
            scope.check_object(spec.container, (*loc, "container"))
        case ObjectCheck():
            scope.check_object(spec.object, (*loc, "object"), simulated=spec.check != "slip")
        case Static(object=str(name)):
            scope.check_object(name, (*loc, "object"), simulated=True)
        case Between() | Clearance() | Collision():
            for index, name in enumerate(spec.between or ()):
                scope.check_body(name, (*loc, "between", index), special=SPECIAL)
        case Sees():
            scope.check_camera(spec.camera, (*loc, "camera"))
            if spec.object is not None:
                scope.check_object(spec.object, (*loc, "object"), simulated=True)
        case TcpPose():
            scope.check_link(spec.link, (*loc, "link"))
        case TcpPath():
            for keys, pose in spec.corners():
                scope.check_frame(pose.frame, (*loc, *keys, "frame"))
        case Formula(formula=text):
            _check_formula(text, (*loc, "formula"), scope)
        case Joints():
            for name in spec.positions:
                scope.check_joint(name, (*loc, "positions", name))
        case NamedTarget():
            group = scope.check_group(spec.group, (*loc, "group"))
            scope.check_state(group, spec.state, (*loc, "state"))
        case GripperState(named_target=str(state)):
            hand = scope.description.gripper
            if hand is not None:
                scope.check_state(hand.group, state, (*loc, "named_target"))
        case _:
            pass
    pose = getattr(spec, "pose", None)
    if isinstance(pose, Pose):
        scope.check_frame(pose.frame, (*loc, "pose", "frame"))


def _check_formula(text: str, loc: Loc, scope: Scope) -> None:
    """Names of a formula's signals, each problem under its name."""
    robot = scope.description
    bodies = (*SPECIAL, *scope.objects, *robot.link_names)
    known = {"joint": robot.joint_names, "frame": ("tcp", *bodies[len(SPECIAL) :]), "body": bodies}
    for signal in signals_of(parse_formula(text)):
        kinds, _, _ = SIGNALS[signal.name]
        for kind, name, start in zip(kinds, signal.arguments, signal.starts, strict=True):
            if name not in known[kind]:
                what = {"joint": "joint", "frame": "link or object", "body": "object or link"}
                scope.problems.unknown(loc, what[kind], name, known[kind], start=start)
