"""lifted: higher than at the start, and nothing but the fingers holds it up."""

from __future__ import annotations

import numpy as np

from harness.assertions.contacts import (
    TOUCH_FORCE,
    bodies_touching,
    finger_links,
    gripper_of,
    held_by_fingers,
    side_forces,
    weld_note,
)
from harness.assertions.poses import object_poses, present, start_poses
from harness.assertions.registry import Evidence, MarginSignal, signal
from harness.assertions.support import rides_on
from harness.assertions.text import amount, amounts
from harness.assertions.window import Window, object_record
from harness.recording.run import Measure
from harness.spec.checks import Lifted


@signal.handles(Lifted)
def lifted(check: Lifted, window: Window) -> MarginSignal:
    """Height above the object's start, less what is asked for [m].

    Where a finger side does not touch the object, or anything but the gripper and what rests on it
    does, its height counts for nothing: the margin there is `-above`, less still if it has sunk.
    """
    run, name = window.run, check.object
    gripper = gripper_of(run)
    fingers = finger_links(gripper)
    rise = object_poses(run, name)[:, 2] - start_poses(run, name)[:, 2]
    sides = side_forces(run, name)
    others = bodies_touching(run, name, but=fingers | {gripper.palm_link})
    others = {
        body: np.where(rides_on(run, body, name), 0.0, force) for body, force in others.items()
    }
    touched = np.zeros(len(rise), dtype=bool)
    unknown = ~present(run, name)
    for force in others.values():
        touched |= force > TOUCH_FORCE
        unknown |= np.isnan(force)
    alone_in_hand = held_by_fingers(run, name) & ~touched
    counted = np.where(alone_in_hand, rise, np.minimum(rise, 0.0))
    values = np.where(unknown, np.nan, counted - check.above)

    def evidence(index: int) -> Evidence:
        sample, time = window.start + index, window.time(index)
        height = float(rise[sample])
        text = f"lifted {' of '.join(amounts(height, check.above, 'm'))}"
        text += ": " + ", ".join(
            f"{side} finger {amount(float(force[sample]), 'N')}" for side, force in sides.items()
        )
        carriers = [body for body, force in others.items() if force[sample] > TOUCH_FORCE]
        if carriers:
            text += f"; {name} touches {' and '.join(carriers)}"
        elif not alone_in_hand[sample]:
            text += f"; nothing holds {name}"
        text += weld_note(run, name)
        if not object_record(run, name).in_simulation:
            text += f"; {name} is not in the physics"
        measures = [Measure("height gained", height, check.above, ">=", "m", time, name)]
        measures += [
            Measure(f"{side} finger force", float(force[sample]), TOUCH_FORCE, ">=", "N", time)
            for side, force in sides.items()
        ]
        measures += [
            Measure(
                "other contact", float(others[body][sample]), TOUCH_FORCE, "<=", "N", time, body
            )
            for body in carriers
        ]
        return Evidence(text, tuple(measures))

    return MarginSignal(window.cut(values), "m", evidence, progress=window.cut(rise))
