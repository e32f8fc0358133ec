"""What happened when: steps, verdicts and findings, as JSON and as a log."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any

from harness.plugins.ros.bag.messages import TYPES, message, stamp
from harness.plugins.ros.bag.samples import Message
from harness.plugins.ros.bag.topics import EVENTS, ROSOUT
from harness.recording.plain import to_plain
from harness.recording.run import Run
from harness.recording.step_record import StepRecord
from harness.recording.stored_run import StoredRun
from harness.recording.verdict import Verdict

NODE = "armharness"
LOG = "rcl_interfaces/msg/Log"
Log: Any = TYPES[LOG]


@dataclass(frozen=True)
class Event:
    """Something that happened.

    Attributes:
        content: Plain data for programs; its `event` says which it is.
    """

    time: float
    text: str
    level: int
    content: Mapping[str, Any]


def event_messages(stored: StoredRun) -> Iterator[Message]:
    """Every event twice: as JSON on the harness' own topic, and in the log of every tool."""
    file = PurePath(stored.run.file).name  # where it was is no part of what happened
    for event in events(stored):
        text = json.dumps(event.content, ensure_ascii=False, allow_nan=False)
        yield Message(event.time, EVENTS, message(EVENTS.msgtype, data=text))
        yield Message(
            event.time,
            ROSOUT,
            message(
                LOG, stamp=stamp(event.time), level=event.level, name=NODE, msg=event.text,
                file=file, line=int(event.content.get("line", 0)),
            ),
        )  # fmt: skip


def events(stored: StoredRun) -> list[Event]:
    """The run's, in order of time; what ends does so before what begins."""
    run = stored.run
    first, last = float(run.signals.times[0]), float(run.signals.times[-1])
    head = {"event": "run_started", "scenario": run.scenario, "case": run.case, "seed": run.seed}
    tail = {"event": "run_finished", "outcome": stored.outcome, "digest": stored.digest}
    events = [*_steps(run), *_presence(run), *_attachments(run), *_findings(run, last)]
    events += [_verdict(verdict, last) for verdict in stored.verdicts]
    return [
        Event(first, f"run: {run.scenario}", Log.INFO, head),
        *sorted(events, key=lambda event: event.time),
        Event(last, f"outcome: {stored.outcome}", _level(stored.outcome == "passed"), tail),
    ]


def _steps(run: Run) -> list[Event]:
    """Begin and end of every step; nested ones end before the block they stand in."""
    events: list[Event] = []
    begun: list[StepRecord] = []

    def finish_but(path: str) -> None:
        while begun and not path.startswith(f"{begun[-1].path}."):
            events.append(_finished(begun.pop()))

    for step in run.steps:
        finish_but(step.path)
        if step.status == "not reached":
            continue
        events.append(_started(step))
        begun.append(step)
    finish_but("")
    end = float(run.signals.times[-1])
    events += [_not_reached(step, end) for step in run.steps if step.status == "not reached"]
    return events


def _step(event: str, step: StepRecord) -> dict[str, Any]:
    names = {"event": event, "step": step.id, "path": step.path, "verb": step.verb}
    return names | {"summary": step.summary, "line": step.line}


def _started(step: StepRecord) -> Event:
    text = f"{step.id}: {step.summary}"
    return Event(step.start_time, text, Log.INFO, _step("step_started", step))


def _finished(step: StepRecord) -> Event:
    content = _step("step_finished", step) | {"status": step.status}
    content |= {"error_code": step.error_code, "message": step.message}
    content |= {"result": to_plain(step.result)}
    text = f"{step.id}: {step.status}"
    text += f": {step.error_code}: {step.message}" if step.error_code else ""
    return Event(step.end_time, text, _level(step.status != "failed"), content)


def _not_reached(step: StepRecord, end: float) -> Event:
    text = f"{step.id}: not reached"
    return Event(end, text, Log.WARN, _step("step_not_reached", step))


def _presence(run: Run) -> list[Event]:
    """Objects that were added or removed during the run."""
    first, last = float(run.signals.times[0]), float(run.signals.times[-1])
    events: list[Event] = []
    for record in run.objects:
        for number, (begin, end) in enumerate(record.present):
            if number or begin > first:
                content = {"event": "object_added", "object": record.name}
                events.append(Event(begin, f"{record.name} added", Log.INFO, content))
            if end < last:
                content = {"event": "object_removed", "object": record.name}
                events.append(Event(end, f"{record.name} removed", Log.INFO, content))
    return events


def _attachments(run: Run) -> list[Event]:
    """What the planning scene fixed to a link, and let go."""
    events: list[Event] = []
    for record in run.attachments:
        content = {"object": record.object, "link": record.link, "represents": record.represents}
        pose = {"pose_in_link": list(record.pose_in_link)}
        begin = {"event": "attached", **content, **pose}
        text = f"{record.object} attached to {record.link}"
        events.append(Event(record.start_time, text, Log.INFO, begin))
        if math.isfinite(record.end_time):
            end = {"event": "detached", **content}
            text = f"{record.object} detached from {record.link}"
            events.append(Event(record.end_time, text, Log.INFO, end))
    return events


def _findings(run: Run, last: float) -> list[Event]:
    events: list[Event] = []
    for finding in run.findings:
        time = finding.time if math.isfinite(finding.time) else last
        content = {"event": "finding", "kind": finding.kind, "step": finding.step}
        events.append(
            Event(time, finding.message, Log.WARN, content | {"message": finding.message})
        )
    return events


def _verdict(verdict: Verdict, last: float) -> Event:
    content = {
        "event": "verdict", "expectation": verdict.expectation, "status": verdict.status,
        "margin": _finite(verdict.margin), "unit": verdict.unit, "step": verdict.step,
        "line": verdict.line, "reason": verdict.reason, "points": verdict.points,
    }  # fmt: skip
    text = f"{verdict.expectation}: {verdict.status}: {verdict.reason}"
    time = verdict.time if math.isfinite(verdict.time) else last
    return Event(time, text, _level(verdict.status == "passed"), content)


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _level(is_good: bool) -> int:
    return Log.INFO if is_good else Log.ERROR
