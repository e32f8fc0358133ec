"""`harness describe`: what stands where in a scenario."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar

from harness.cli.command import SCENARIOS, Command
from harness.cli.files import one_scenario
from harness.cli.output import say_json, say_text
from harness.cli.shared_options import add_json, add_preparation, add_seed

if TYPE_CHECKING:
    from harness.plugins.agents.scene_facts import (
        LaterFacts,
        ObjectFacts,
        PickFacts,
        RobotFacts,
        SceneFacts,
        SideFacts,
    )


class DescribeCommand(Command):
    """Describe the scene of a scenario: objects, reach, clearances, graspable widths."""

    name: ClassVar[str] = "describe"
    group: ClassVar[str] = SCENARIOS
    reads_geometry: ClassVar[bool] = True

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness describe`."""
        command.add_argument(
            "scenario", metavar="SCENARIO", help="a scenario file, or a bundled name"
        )
        add_preparation(command)
        add_seed(command)
        add_json(command)

    def run(self, arguments: argparse.Namespace) -> int:
        """Describe the scene; nothing moves."""
        file = one_scenario(arguments.scenario)
        from harness.plugins.agents.scene_facts import scene_facts
        from harness.session.prepare import prepare

        prepared = prepare(file, dict(arguments.overrides), arguments.seed)
        facts = scene_facts(prepared, str(file))
        if arguments.json:
            say_json(facts)
        else:
            say_text("\n".join(_text(facts)))
        return 0


def _text(facts: SceneFacts) -> Iterator[str]:
    yield f"{facts.file}: {facts.scenario}"
    yield "lengths in m, angles in rad, poses in the world"
    yield from _robot(facts.robot)
    for obj in facts.objects:
        yield from _object(obj)
    for obj in facts.added_later:
        yield f"added by a step: {obj.name}, {_size(obj)}{_where(obj)}"
    if facts.cameras:
        yield f"cameras: {', '.join(facts.cameras)}"


def _robot(robot: RobotFacts) -> Iterator[str]:
    yield f"robot: {robot.name}"
    base, tcp = _row(robot.base.xyz), _row(robot.tcp.xyz)
    yield f"  {robot.base_link or 'base'} at {base}; {robot.tcp_link} at {tcp}"
    if robot.reach is not None:
        low, high = robot.reach.low, robot.reach.high
        sides = (f"{axis} {a:g} to {b:g}" for axis, a, b in zip("xyz", low, high, strict=True))
        yield f"  reach: {robot.reach.farthest:g} from {robot.base_link}; {', '.join(sides)}"
    if robot.gripper is not None:
        hand = robot.gripper
        widths = f"{hand.closes_to:.4g} to {hand.opens_to:.4g}"
        yield f"  gripper: {hand.joint}, holds widths from {widths}"
    for group, states in robot.named_states.items():
        if states:
            yield f"  named states of {group}: {', '.join(states)}"


def _object(obj: ObjectFacts) -> Iterator[str]:
    mass = "static" if obj.mass is None else f"{obj.mass:g} kg"
    at = f" at {_row(obj.pose.xyz)}"
    top = f", top at z {obj.high[2]:g}" if obj.high else ""
    yield f"{obj.name}: {_size(obj)}, {mass}{at}{top}{_where(obj)}"
    if obj.clearance is not None:
        yield f"  {obj.clearance.distance:.4g} from {obj.clearance.link}"
    if obj.level_sides:
        yield f"  level sides: {', '.join(_side(side) for side in obj.level_sides)}"
    if obj.pick is not None:
        yield f"  pick: {_pick(obj.pick)}"


def _side(side: SideFacts) -> str:
    return f"{side.width:.4g} ({'fits' if side.fits else 'does not fit'} the gripper)"


def _pick(pick: PickFacts) -> str:
    if pick.is_possible:
        return f"possible, {pick.grasps} grasps" if pick.grasps != 1 else "possible, 1 grasp"
    advice = f"; {pick.advice}" if pick.advice else ""
    return f"{pick.error_code}: {pick.message}{advice}"


def _size(obj: LaterFacts) -> str:
    return (
        obj.shape if obj.size is None else f"{obj.shape} {' x '.join(f'{x:.4g}' for x in obj.size)}"
    )


def _where(obj: LaterFacts) -> str:
    return f" (in {obj.is_in[0]} alone)" if len(obj.is_in) == 1 else ""


def _row(values: tuple[float, ...]) -> str:
    return f"({', '.join(f'{value:.4g}' for value in values)})"
