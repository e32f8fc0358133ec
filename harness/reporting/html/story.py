"""Steps, verdicts, findings and surroundings of a run, as the page shows them."""

from __future__ import annotations

import math
import shlex
from collections.abc import Sequence
from typing import Any

import numpy as np

from harness.core.resources import with_short_names
from harness.recording.plain import to_plain
from harness.recording.plan_statistics import PlanStatistics
from harness.recording.run import Run
from harness.recording.step_record import StepRecord, is_nested
from harness.recording.stored_run import StoredRun
from harness.recording.verdict import Verdict
from harness.reporting.html.nearest import nearest_points
from harness.reporting.margins import tightest_name, used_allowance
from harness.robot.mechanism import Joint

EXTERNAL = "external"
"""The verb of the step in which programs outside command the robot."""

OF_STARTS = "overlap", "link_overlap", "nothing_expected", "coupling", "looks", "doubt"
WARNINGS = (*OF_STARTS, "fault_without_effect", "fallen_part", "held_at_once")
"""Kinds of findings by which a run may mean less than it seems to; others are notes."""

TONES = {"passed": "good", "expected error": "good", "failed": "bad", "not reached": "open"}


def ordered_steps(run: Run) -> list[StepRecord]:
    """Steps as a person reads them: a step before those nested in it."""
    order = {step.path: number for number, step in enumerate(run.steps)}

    def key(step: StepRecord) -> tuple[int, int]:
        nested = [order[each.path] for each in run.steps if is_nested(each.path, step.path)]
        return min([order[step.path], *nested]), depth_of(step, run)

    return sorted(run.steps, key=key)


def depth_of(step: StepRecord, run: Run) -> int:
    """The number of steps that a step is nested in."""
    return sum(is_nested(step.path, other.path) for other in run.steps)


def step_facts(run: Run, step: StepRecord, verdicts: Sequence[Verdict]) -> dict[str, Any]:
    """A step as plain data; one whose own expectations do not hold looks failed."""
    tone = TONES[step.status]
    broken = [each for each in verdicts if each.step == step.id and each.status == "failed"]
    return {
        "tone": "bad" if broken and tone == "good" else tone,
        "broken": [f"{each.expectation}: {each.reason or each.status}" for each in broken],
        "id": step.id,
        "verb": step.verb,
        "summary": step.summary,
        "line": step.line,
        "lastLine": last_line(run.source, step.line),
        "status": step.status,
        "errorCode": step.error_code,
        "message": step.message,
        "start": step.start_time,
        "end": step.end_time,
        "depth": depth_of(step, run),
        "hasChildren": any(is_nested(other.path, step.path) for other in run.steps),
        "planner": finite(
            {key: value for key, value in step.planner.plain().items() if key != "raw_path"}
        ),
        "explanation": finite(step.explanation),
        "commands": command_rows(run, step),
    }


def command_rows(run: Run, step: StepRecord) -> list[dict[str, Any]]:
    """What programs outside commanded in a step; messages of a topic in a row are one row."""
    rows: list[dict[str, Any]] = []
    if step.verb != EXTERNAL:
        return rows
    others = [each for each in run.steps if each.verb == EXTERNAL and each.end_time > 0]
    for command in run.commands:
        owners = (each for each in others if each.start_time <= command.time <= each.end_time)
        if next(owners, step).path != step.path:
            continue
        row = {
            "what": f"{command.controller} {command.summary or command.kind}".strip(),
            "answer": command.result or command.answer,
            "isBad": command.has_failed,
            "isGoal": bool(command.goal),
        }
        if rows and not command.goal and all(rows[-1][key] == row[key] for key in row):
            rows[-1] |= {"until": command.time, "count": rows[-1]["count"] + 1}
        else:
            rows.append({**row, "time": command.time, "until": None, "count": 1})
    return rows


def verdict_facts(run: Run, verdict: Verdict) -> dict[str, Any]:
    """A verdict as plain data."""
    first = verdict.measures[0] if verdict.measures else None
    return {
        "text": verdict.expectation,
        "status": verdict.status,
        "margin": _number(verdict.margin),
        "unit": verdict.unit,
        "used": used_allowance(verdict),
        "tightest": tightest_name(verdict),
        "time": _number(verdict.time),
        "line": verdict.line,
        "step": verdict.step,
        "reason": verdict.reason,
        "warnings": [str(warning) for warning in verdict.warnings],
        "measures": finite(verdict.measures),
        "plot": (first.plot or None) if first else None,
        "points": _points(verdict),
        "credit": verdict.credit,
        "nearest": nearest_points(run, verdict),
        "bodies": bodies_of(run, verdict),
    }


def _points(verdict: Verdict) -> dict[str, list[float]] | None:
    """Expected and actual point, of the first measure that has them."""
    for measure in verdict.measures:
        if measure.expected and measure.actual:
            points = {"expected": list(measure.expected), "actual": list(measure.actual)}
            return points if np.isfinite([*measure.expected, *measure.actual]).all() else None
    return None


def bodies_of(run: Run, verdict: Verdict) -> list[str]:
    """Links and objects that the first measure is about: a pair, a body, or the link of a joint."""
    if not verdict.measures:
        return []
    about = verdict.measures[0].detail
    joint = run.robot.joint_by_name.get(about)
    if joint is not None:
        return [joint.child]
    known = {*run.robot.link_names, *(obj.name for obj in run.objects)}
    return [name for name in about.split(" and ") if name in known]


def findings_facts(run: Run) -> list[dict[str, Any]]:
    """What a person should know that is no verdict."""
    return [
        {
            "kind": finding.kind,
            "message": finding.message,
            "isWarning": finding.kind in WARNINGS or finding.values.get("held") is False,
            "time": _number(finding.time),
            "step": finding.step,
        }
        for finding in run.findings
    ]


def contact_facts(run: Run) -> list[dict[str, Any]]:
    """The contacts of a run, by their first time."""
    return [
        {
            "first": contact.pair[0],
            "second": contact.pair[1],
            "time": _number(contact.first_time),
            "duration": _number(contact.duration),
            "peak": _number(contact.peak_force),
            "isCollision": contact.is_collision,
        }
        for contact in run.contacts
    ]


def joint_facts(run: Run) -> list[dict[str, Any]]:
    """What each joint did against its limits; None where a recording does not say."""
    return [_joint(run, joint, column) for column, joint in enumerate(run.robot.movable_joints)]


def _joint(run: Run, joint: Joint, column: int) -> dict[str, Any]:
    slides = joint.kind == "prismatic"
    factor = 1e3 if slides else 180 / math.pi
    positions, speeds, efforts = (
        array[:, column][np.isfinite(array[:, column])]
        for array in (
            run.signals.joint_positions,
            np.abs(run.signals.joint_velocities),
            np.abs(run.signals.joint_efforts),
        )
    )
    return {
        "name": joint.name,
        "unit": "mm" if slides else "°",
        "low": _number(factor * positions.min(initial=math.inf)),
        "high": _number(factor * positions.max(initial=-math.inf)),
        "lower": _number(factor * joint.lower),
        "upper": _number(factor * joint.upper),
        "speed": _number(factor * speeds.max(initial=-math.inf)),
        "speedLimit": _number(factor * joint.velocity),
        "effort": _number(efforts.max(initial=-math.inf)),
        "effortLimit": _number(joint.effort),
    }


def command_again(run: Run) -> str:
    """The command that runs this case as it was run; empty for a recording, which none repeats."""
    if "mujoco" not in run.versions or not run.file:
        return ""
    case = ["--case", run.case] if run.case else []
    return shlex.join(["harness", "run", with_short_names(run.file), *case, *run.options])


def environment(stored: StoredRun) -> list[tuple[str, str]]:
    """Everything one needs to run it again and get the same."""
    run = stored.run
    tips = [arm.tcp_link for arm in run.robot.arms]
    rows = [
        ("scenario", run.scenario),
        ("file", run.file),
        ("case", run.case),
        ("options", shlex.join(run.options)),
        ("seed", str(run.seed) if "mujoco" in run.versions else ""),
        ("digest", stored.digest),
        ("robot", run.robot.name),
        ("gripper group", ", ".join(hand.group for hand in run.robot.grippers)),
        ("tool frame", ", ".join(tips or [run.robot.tcp_link])),
        ("planners", ", ".join(_planners(run))),
        ("time step", f"{1e3 * run.timestep:g} ms"),
        ("gravity", f"{', '.join(f'{value:g}' for value in run.gravity)} m/s²"),
        ("samples", f"{len(run.signals.times)}"),
        ("ended early", run.ended_early),
        *((name, version) for name, version in run.versions.items()),
        *((f"{name}, wall time", f"{value:.2f} s") for name, value in stored.wall_times.items()),
    ]
    return [(name, value) for name, value in rows if value]


def _planners(run: Run) -> list[str]:
    plans = (step.planner.find(PlanStatistics) for step in run.steps)
    return list(dict.fromkeys(plan.planner_id for plan in plans if plan is not None))


def last_line(source: str, line: int) -> int:
    """The last line of the block of a YAML list that begins at a line."""
    lines = source.splitlines()
    if not 0 < line <= len(lines):
        return line
    indent = _indent(lines[line - 1])
    last = line
    for number in range(line, len(lines)):
        text = lines[number]
        if text.strip() and not text.lstrip().startswith("#"):
            if _indent(text) <= indent:
                break
            last = number + 1
    return last


def _indent(text: str) -> int:
    return len(text) - len(text.lstrip())


def finite(value: Any) -> Any:
    """Plain data as JSON in a browser takes it: numbers that are not finite as null."""
    return to_plain(value, not_finite="null")


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
