"""on: the object stands on another."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from harness.cell.possible_contacts import check_contact
from harness.cell.scope import At
from harness.core.amounts import amounts
from harness.judging.contacts import DEBOUNCE
from harness.judging.expectation import ObjectPredicate
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.poses import present
from harness.judging.support import required_support, supports
from harness.judging.window import Window
from harness.language.base import Name
from harness.language.expectation import Quantity
from harness.plugins.objects.settled import settled
from harness.recording.verdict import Measure

SUPPORT = Quantity("support from below", "N", "at least half of its weight, within 1 %")


class On(ObjectPredicate):
    """The object stands on another: in contact, above it, its weight carried by it."""

    sentence = "{object} is on {support}"
    quantities = (SUPPORT,)

    support: Name = Field(description="The object or link that the object stands on.")

    def check(self, at: At) -> None:
        super().check(at)
        at.scope.check_body(self.support, at.key("support"), special=())
        check_contact(at.scope, self.object, self.support, at.key("support"))

    def looks_back(self) -> float:
        return DEBOUNCE

    def signal(self, window: Window) -> MarginSignal:
        """Touches the support, which is under it and carries half of its weight or more."""
        run, name = window.run, self.object
        force = supports(run, name).get(self.support, np.zeros(len(run.signals.times)))
        limit = required_support(run, name)
        counts = settled(run, force >= limit, {name, self.support})
        part = Part(SUPPORT, window.cut(force), limit, ">=", detail=self.support)

        def text(_: int, measure: Measure) -> str:
            force, required = amounts(measure.value, limit, "N")
            return f"{self.support} carries {name} with {force} of {required}"

        here, counts = window.cut(present(run, name)), window.cut(counts)
        return all_of(window, [part], text, present=here, applies=counts)
