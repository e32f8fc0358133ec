"""Pictures of what failed steps are explained by: named in the record, drawn into the report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from harness.cameras.stills import step_slug
from harness.core.activity import Activity, unobserved
from harness.core.world import WorldObject
from harness.recording.run import Run, StepRecord
from harness.robot.description import RobotDescription

FOLDER = "images"


def with_pictures(run: Run) -> Run:
    """The run with the file of its picture in each explanation that has a state to draw."""
    return replace(
        run, steps=tuple(_named(step, number) for number, step in enumerate(run.steps, start=1))
    )


def draw_pictures(
    description: RobotDescription,
    objects: Sequence[WorldObject],
    run: Run,
    folder: Path,
    activity: Activity = unobserved,
) -> None:
    """Draw what `with_pictures` has named, into a report's folder."""
    wanted = [step for step in run.steps if "picture" in step.explanation]
    if not wanted:
        return
    from harness.cameras.failure_pictures import draw_failure

    (folder / FOLDER).mkdir(parents=True, exist_ok=True)
    for number, step in enumerate(wanted):
        activity("drawing why steps failed", number, len(wanted))
        draw_failure(description, objects, run, step, folder / step.explanation["picture"])


def _named(step: StepRecord, number: int) -> StepRecord:
    if "nearest" not in step.explanation:
        return step

    name = f"{FOLDER}/{number:02d}-{step_slug(step.id)}-why.jpg"
    return replace(step, explanation={**step.explanation, "picture": name})
