"""in_contact, and the words that name sets of bodies."""

from __future__ import annotations

import numpy as np

from harness.assertions.contacts import TOUCH_FORCE, finger_links, force_between
from harness.assertions.registry import MarginSignal, Part, all_of, signal
from harness.assertions.text import amount
from harness.assertions.window import NotObservable, Window
from harness.recording.run import Measure, Run
from harness.spec.checks import InContact


def bodies(run: Run, word: str) -> frozenset[str]:
    """Links and objects that a word of `between` means: `robot`, `gripper`, `any`, or a name.

    Raises:
        NotObservable: The run knows no such body.
    """
    robot = run.robot
    links = frozenset(robot.link_names)
    objects = frozenset(record.name for record in run.objects)
    match word:
        case "robot":
            return links
        case "gripper" if robot.gripper is not None:
            return finger_links(robot.gripper) | ({robot.gripper.palm_link} - {""})
        case "any":
            return links | objects | {name for pair in run.signals.contact_forces for name in pair}
        case _ if word in links or word in objects:
            return frozenset({word})
        case _:
            raise NotObservable(f"there is no body '{word}' in this run")


def sample_time(run: Run) -> float:
    """Between two samples of a run [s]; 0 when it has one."""
    times = run.signals.times
    return float(np.median(np.diff(times))) if len(times) > 1 else 0.0


@signal.handles(InContact)
def in_contact(check: InContact, window: Window) -> MarginSignal:
    """Force between the two bodies [N], sample by sample."""
    first, second = check.between
    run = window.run
    force = window.cut(force_between(run, bodies(run, first), bodies(run, second)))
    limit = max(check.min_force, TOUCH_FORCE)
    part = Part("contact force", force, limit, ">=", "N", detail=f"{first} and {second}")

    touching = np.flatnonzero(force >= TOUCH_FORCE)

    def text(_: int, measure: Measure) -> str:
        said = f"{first} and {second} touch with {amount(measure.value, 'N')}"
        if not len(touching):
            return said
        begun, seconds = window.time(int(touching[0])), len(touching) * sample_time(run)
        peak = amount(float(force.max()), "N")
        return f"{said} (first at t={begun:.3f} s, {amount(seconds, 's')} in all, up to {peak})"

    return all_of(window, [part], text)
