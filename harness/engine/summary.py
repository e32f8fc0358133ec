"""A step in a few words."""

from __future__ import annotations

from collections.abc import Iterable

from harness.spec.base import SpecModel
from harness.spec.goals import GoalFields
from harness.spec.steps import (
    AddObject,
    AllowCollisions,
    AnyStep,
    AttachObject,
    Capture,
    CartesianPath,
    ClearObjects,
    Grasp,
    Gripper,
    Inject,
    MoveRelative,
    MoveTo,
    Parallel,
    RemoveObject,
    Repeat,
    Sequence,
    Wait,
)


def words(models: Iterable[type], tag: str) -> list[str]:
    """How files spell some models, sorted: `words(execute, "do")` are the executed verbs."""
    return sorted(
        str(model.model_fields[tag].default) for model in models if issubclass(model, SpecModel)
    )


def summarize(step: AnyStep) -> str:
    """One line for a person: `move_to mogi_home`."""
    if step.name:
        return f"{step.do} {step.name}"
    return f"{step.do} {_content(step)}".rstrip()


def _content(step: AnyStep) -> str:
    match step:
        case MoveTo(any_of=goals) if goals is not None:
            return "any of " + ", ".join(_goal(goal) for goal in goals)
        case GoalFields():
            return _goal(step)
        case CartesianPath():
            many = len(step.waypoints)
            return f"through {many} waypoint" + ("" if many == 1 else "s")
        case Sequence():
            return ", ".join(
                next(word for word in ("ptp", "lin", "circ") if getattr(item, word) is not None)
                for item in step.items
            )
        case Gripper():
            if step.named_target is not None:
                return step.named_target
            if step.position is not None:
                return f"to {step.position:g}"
            return f"width {(step.width or 0.0) * 1e3:g} mm"
        case Grasp():
            return step.object if step.mode == "friction" else f"{step.object} ({step.mode})"
        case MoveRelative():
            amount = step.distance or step.max_distance
            return f"{amount:g} m" if amount else f"{step.angle or 0.0:g} rad"
        case AttachObject():
            name = step.object if isinstance(step.object, str) else step.object.name
            return f"{name} for {step.represents}" if step.represents else name
        case AddObject():
            return ", ".join(spec.name for spec in step.objects)
        case RemoveObject():
            return ", ".join(step.objects)
        case ClearObjects():
            return "with the world's" if step.world else ""
        case AllowCollisions():
            return ", ".join(f"{a}-{b}" for a, b in step.pairs)
        case Repeat():
            return f"{step.times} times" if step.times > 1 else ""
        case Parallel():
            return " and ".join(child.do for child in step.steps)
        case Inject():
            return ", ".join(_faults(step))
        case Capture():
            return f"{step.camera}: {', '.join(step.kinds)}"
        case Wait():
            return f"{step.duration:g} s"
        case _:
            name = getattr(step, "object", None)
            return name if isinstance(name, str) else ""


def _faults(step: Inject) -> list[str]:
    """`friction of green_cylinder 0.02`, and so on."""
    said = [f"friction of {name} {value:g}" for name, value in (step.friction or {}).items()]
    said += [f"push {name}" for name in step.push or {}]
    if step.gripper_effort is not None:
        said.append(f"gripper effort {step.gripper_effort:.0%}")
    if step.joint_stall is not None:
        said.append(f"stall {step.joint_stall}")
    if step.sensor_noise is not None:
        said.append(f"sensor noise {step.sensor_noise:g} rad")
    if step.command_latency is not None:
        said.append(f"latency {step.command_latency * 1e3:g} ms")
    return said


def _goal(goal: GoalFields) -> str:
    if goal.named_target is not None:
        return goal.named_target
    if goal.joints is not None:
        return "joints " + ", ".join(f"{value:.4g}" for value in goal.joints.values())
    place = goal.pose or goal.position
    if place is None:
        return ""
    x, y, z = place.xyz
    return f"({x:.4g}, {y:.4g}, {z:.4g}) in {place.frame}"
