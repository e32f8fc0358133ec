"""grasp: close until both finger sides touch the object, then attach it in the planning scene."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.closing import closing_obstacles, higher_grasp, position_around
from harness.cell.grip import grip_of
from harness.cell.scope import At
from harness.cell.step import Step
from harness.core.details import Details
from harness.core.errors import StepFailed
from harness.language.base import JointEffort, JointValue, Name
from harness.ports.scene import Touch
from harness.ports.simulation import ExpectedGrasp, GripperResult
from harness.recording.execution_failures import GraspFailure, GripperOutcome
from harness.recording.explanation import Explanation
from harness.recording.step_results import GraspMode
from harness.steps.gripper import DEFAULT_TIMEOUT, check_gripper_position, note_result

GripperAction = Annotated[
    Literal["friction", "weld"],
    Field(
        description="`friction` holds the object by contact; `weld` also fixes it in the physics."
    ),
]
HoldingEffort = Annotated[
    Annotated[JointEffort, Field(gt=0)] | None,
    Field(
        description="The effort limit of the gripper's joint while it holds; the default is the "
        "robot's."
    ),
]


class Grasp(Step):
    """Close until both finger sides press the object, verify, attach it in the planning scene.

    Both sides must press it from opposite sides, as `grasped` defines it: tips that close on top of
    a larger object touch it and grasp nothing.
    """

    short = "object"

    verb: ClassVar[str] = "grasp"
    plans: ClassVar[bool] = False
    moves_gripper: ClassVar[bool] = True
    keeps_arm_still: ClassVar[bool] = True
    results = (GripperOutcome, GraspMode)

    object: Name = Field(description="The name of the object.")
    mode: GripperAction = "friction"
    max_effort: HoldingEffort = None
    position: JointValue | None = Field(
        default=None,
        description="The gripper's joint closes to this position at most; the default is closed.",
    )

    def summary(self) -> str:
        return self.object if self.mode == "friction" else f"{self.object} ({self.mode})"

    def check(self, at: At) -> None:
        if at.scope.check_gripper(at.loc, "`grasp`"):
            check_gripper_position(self.position, at)
        check_graspable(self.object, at, self.mode, by_all_cups=False)
        at.scope.attached[self.object] = None

    def execute(self, cell: Cell) -> None:
        """Close, verify that opposite sides press it, attach; `weld` fixes it in the physics too.

        Raises:
            StepFailed: CONTROL_FAILED, when a finger side does not touch the object, or the sides
                do not press it from opposite sides.
        """
        hand = cell.gripper
        target = hand.closed_position if self.position is None else self.position
        cell.sync_scene()
        state = cell.planning_start()
        obstacles = closing_obstacles(self.object, state, cell)
        result = cell.simulator.command_gripper(
            target,
            self.max_effort or hand.grip_effort,
            timeout=self.timeout or DEFAULT_TIMEOUT,
            expected=ExpectedGrasp(position_around(self.object, state, cell), not obstacles),
            joint=hand.joint,
        )
        outcome = note_result(cell, target, result)
        cell.report(GraspMode(self.mode))
        empty = [side for side, names in result.contacts.items() if self.object not in names]
        if hand.cups and self.object not in result.between:
            raise StepFailed(
                "CONTROL_FAILED",
                f"no suction cup holds '{self.object}': "
                + "; ".join(f"{cup}: {why}" for cup, why in result.unsealed.items()),
                outcome,
                GraspFailure(self.mode),
            )
        if not hand.cups and (empty or self.object not in result.between):
            missed = _missed(self.object, empty) if empty else _not_between(self.object)
            cause, advice = _cause(self.object, result, obstacles, cell)
            message, failure = f"{missed}; {cause}", GraspFailure(self.mode)
            raise StepFailed("CONTROL_FAILED", message, outcome, failure, *advice)
        cell.sync_scene()
        cell.take_hold(self.object, weld=self.mode == "weld")


def check_graspable(name: str, at: At, mode: str, *, by_all_cups: bool) -> None:
    """Report an object that is not there, cannot be held, or is unknown to the planner."""
    scope = at.scope
    obj = scope.objects.get(name)
    if grip := grip_of(scope.description.gripper):
        grip.check(obj, at, mode, by_all_cups=by_all_cups)
    scope.check_present(name, at.key("object"))
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


def _missed(name: str, empty: list[str]) -> str:
    sides = " and ".join(f"the {side} finger" for side in empty)
    return f"{sides} did not touch '{name}' when the gripper closed"


def _not_between(name: str) -> str:
    """Fingers that touch an object and do not have it between them."""
    return (
        f"both fingers touch '{name}', but do not press it from opposite sides: it is not between"
        " them"
    )


def _cause(
    name: str, result: GripperResult, obstacles: Sequence[Touch], cell: Cell
) -> tuple[str, Details]:
    """What the fingers met instead, with advice, or else how the object stands to the TCP."""
    pressed: dict[str, list[str]] = {}
    for forces in result.forces.values():
        for body, force in forces.items():
            if body != name:
                pressed.setdefault(body, []).append(f"{force:.3g} N")
    if pressed:
        where = ", ".join(f"{body} with {' and '.join(each)}" for body, each in pressed.items())
        cause = f"the fingers press {where}"
    elif obstacles and not result.forces:  # without physics
        depths = "; ".join(map(_depth, obstacles))
        cause = f"fingers that close to its width meet something else before: {depths}"
    else:
        return _offset(name, cell), Details()
    advice = (
        f"grasp it {higher_grasp(obstacles, cell)}: with the `grasp_pose` of `pick`, or with the"
        " motion before `grasp`"
    )
    return cause, Details.of(Explanation(advice=advice))


def _depth(touch: Touch) -> str:
    return f"{touch.first} reaches {-1e3 * touch.distance:.1f} mm into {touch.second}"


def _offset(name: str, cell: Cell) -> str:
    tcp = cell.frame(cell.description.tcp_link)
    x, y, z = tcp.inverse().apply(cell.frame(name).translation) * 1e3
    return f"its origin stands ({x:.1f}, {y:.1f}, {z:.1f}) mm from the TCP, in the TCP's axes"
