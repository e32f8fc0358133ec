"""lifted: the object is higher than at the start and nothing but the gripper holds it up."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from harness.assertions.contacts import (
    TOUCH_FORCE,
    bodies_touching,
    finger_links,
    gripper_of,
    held_by_fingers,
    side_forces,
    weld_note,
)
from harness.assertions.expectation import ObjectPredicate
from harness.assertions.margins import Evidence, MarginSignal, measured
from harness.assertions.poses import object_poses, present, start_poses
from harness.assertions.support import rides_on
from harness.assertions.text import amount, amounts
from harness.assertions.window import Window, object_record
from harness.cell.scope import At
from harness.language.base import PositiveLength
from harness.language.expectation import Quantity

HEIGHT = Quantity(
    "height gained", "m", "at least `above`; counts for nothing where another fails", "height"
)
FINGERS = Quantity(
    "finger force", "N", "at least 0.001 N on every side, from both sides", "contact"
)
OTHERS = Quantity(
    "other contact", "N", "at most 0.001 N, but with the gripper and what rests on it", "contact"
)


class Lifted(ObjectPredicate):
    """The object is higher than at the start and nothing but the gripper holds it up."""

    judged = "eventually"
    quantities = (HEIGHT, FINGERS, OTHERS)
    is_change = True

    above: PositiveLength = Field(
        default=0.01, description="The height above the object's own start height [m]."
    )

    def check(self, at: At) -> None:
        at.scope.check_gripper(at.loc, "`lifted`")
        super().check(at)

    def signal(self, window: Window) -> MarginSignal:
        """Height above the object's start, less the required height [m].

        Where a finger side does not touch the object, or anything but the gripper and what rests on
        it does, its height counts for nothing: the margin there is `-above`, less if it has sunk.
        """
        run, name = window.run, self.object
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
        values = np.where(unknown, np.nan, counted - self.above)

        def evidence(index: int) -> Evidence:
            sample, time = window.start + index, window.time(index)
            height = float(rise[sample])
            text = f"lifted {' of '.join(amounts(height, self.above, 'm'))}"
            text += ": " + ", ".join(
                f"{side} finger {amount(float(force[sample]), 'N')}"
                for side, force in sides.items()
            )
            carriers = [body for body, force in others.items() if force[sample] > TOUCH_FORCE]
            if carriers:
                text += f"; {name} touches {' and '.join(carriers)}"
            elif not alone_in_hand[sample]:
                text += f"; nothing holds {name}"
            text += weld_note(run, name)
            if not object_record(run, name).in_simulation:
                text += f"; {name} is not in the physics"
            measures = [measured(HEIGHT, height, self.above, ">=", time, name)]
            measures += [
                measured(
                    FINGERS,
                    float(force[sample]),
                    TOUCH_FORCE,
                    ">=",
                    time,
                    name=f"{side} finger force",
                )
                for side, force in sides.items()
            ]
            measures += [
                measured(OTHERS, float(others[body][sample]), TOUCH_FORCE, "<=", time, body)
                for body in carriers
            ]
            return Evidence(text, tuple(measures))

        return MarginSignal(window.cut(values), "m", evidence, progress=window.cut(rise))
