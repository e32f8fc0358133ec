"""in_contact: two bodies touch."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from harness.cell.possible_contacts import check_contact
from harness.cell.scope import At
from harness.core.amounts import amount
from harness.judging.contacts import (
    DEBOUNCE,
    FORCE_WINDOW,
    TOUCH_FORCE,
    bodies,
    could_touch,
    force_between,
    pairs_of,
    sample_time,
    unseen_contacts,
)
from harness.judging.expectation import SPECIAL_BODIES, Predicate
from harness.judging.hold import averaged_force
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.observations import Observations
from harness.judging.temporal import without_gaps
from harness.judging.window import Window, lasting
from harness.language.base import Duration, Force, Name
from harness.language.expectation import Quantity
from harness.plugins.objects.settled import settled
from harness.recording.verdict import Measure

CONTACT = Quantity("contact force", "N", "at least `min_force`, and 0.001 N", "contact")


class InContact(Predicate):
    """The two bodies touch.

    A contact lasts through gaps of at most 10 ms, as stiff bodies rattle; what is put where it
    touches presses up to 10 ms later, and is judged from then on, for `on` too. Both have to be in
    the physics: what only the planner knows is not observable, what is not there yet not reached. A
    contact without `min_force` lasts a sample at least; a force is averaged over `force_window`.
    """

    short = "between"
    judged = "eventually"
    sentence = "{between} are in contact[ with at least {min_force}]"
    quantities = (CONTACT,)
    goes_with: ClassVar[Mapping[str, tuple[str, ...]]] = {"force_window": ("min_force",)}
    synonyms = ("contact", "contacts", "touch", "touching")

    between: tuple[Name, Name] = Field(
        description="The two bodies: each a link, an object, `robot`, `gripper` or `any`."
    )
    min_force: Annotated[Force, Field(ge=0)] = Field(
        default=0.0, description="The smallest force that counts as a contact [N]."
    )
    force_window: Duration = Field(
        default=FORCE_WINDOW,
        description="With `min_force`, the force is the mean over this time before each sample; "
        "with 0 the samples of the physics count [s].",
    )

    def check(self, at: At) -> None:
        for index, name in enumerate(self.between):
            at.scope.check_body(name, at.key("between", index), special=SPECIAL_BODIES)
        check_contact(at.scope, *self.between, at.key("between"))

    def observations(self) -> Observations:
        return Observations(clearance_cutoff=0.0)

    def looks_back(self) -> float:
        return self.force_window + DEBOUNCE

    def signal(self, window: Window) -> MarginSignal:
        """Force between the two bodies [N], sample by sample, while both are in the physics.

        Raises:
            NotObservable: Only the planner knows one of them, or the run knows none.
        """
        first, second = self.between
        run = window.run
        firsts, seconds = bodies(run, first), bodies(run, second)
        pairs = pairs_of(firsts, seconds)
        every = force_between(run, firsts, seconds)
        if self.min_force > 0:
            every = averaged_force(run, every, self.force_window)
        force = window.cut(every)
        lasting_force = without_gaps(every, run.signals.times, DEBOUNCE)
        limit = max(self.min_force, TOUCH_FORCE)
        part = Part(CONTACT, window.cut(lasting_force), limit, ">=", detail=f"{first} and {second}")
        touching = np.flatnonzero(force >= TOUCH_FORCE)

        def text(_: int, measure: Measure) -> str:
            now = f"{first} and {second} touch with {amount(measure.value, 'N')}"
            if measure.value == 0:
                now = f"{first} and {second} do not touch"
            if not len(touching):
                return now
            begun, seconds = window.time(int(touching[0])), len(touching) * sample_time(run)
            peak = amount(float(force.max()), "N")
            return f"{now} (first at t={begun:.3f} s, {amount(seconds, 's')} in all, up to {peak})"

        counts = settled(run, lasting_force >= limit, firsts | seconds)
        together = lasting(window.cut(could_touch(run, pairs))) & window.cut(counts)
        return replace(
            all_of(window, [part], text, applies=together),
            pairs=len(pairs),
            warnings=unseen_contacts(run, pairs),
        )
