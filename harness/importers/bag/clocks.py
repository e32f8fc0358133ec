"""One time line for everything recorded, whatever clocks its senders had."""

from __future__ import annotations

import numpy as np

from harness.core.types import BoolArray, FloatArray, IntArray
from harness.importers.bag.content import Track

SET_BACK = 10**9
"""A clock that goes back by more was set back: a restarted simulation [ns]. Less is disorder."""
SAME_CLOCK = 0.5
"""Half of a topic's stamps are within so much of the reference's clock, or it is another [s]."""


class Timeline:
    """Seconds since the first sample of the reference, by its sender's clock.

    Stamps of other topics count as they are where their clock is the same; where it is not (one
    node with `use_sim_time`, the other without; two computers), the recorder's clock leads from one
    to the other. Stamps may be in disorder. Where a clock was set back, only what follows counts.

    Attributes:
        notes: What was found out about clocks.
    """

    def __init__(self, reference: Track) -> None:
        self.notes: list[str] = []
        logged, stamps = reference.times()
        order = np.argsort(logged, kind="stable")
        logged, stamps = logged[order], stamps[order]
        if (stamps.min() == stamps.max() and len(stamps) > 1) or stamps.min() <= 0:
            stamps = logged
            self.notes.append(
                "the joint states have no stamps; the recorder's times stand for them"
            )
        begin = _last_start(stamps)
        self._is_restarted = begin > 0
        if begin:
            self.notes.append(
                "the clock was set back during the recording; what is judged is the part after that"
            )
        self._first_logged = int(logged[begin])
        logged, stamps = logged[begin:], stamps[begin:]
        self._origin = int(stamps.min())
        self._logged = (logged - self._first_logged) / 1e9
        self._stamped = (stamps - self._origin) / 1e9
        self._has_log = bool(self._logged[-1] > 0)

    def rows(self, track: Track, name: str) -> tuple[FloatArray, BoolArray]:
        """Time of every row [s], and which rows are of the part that is judged; shape (N,) each.

        Args:
            track: Of any topic.
            name: For notes.
        """
        logged, stamps = track.times()
        is_judged: BoolArray = np.ones(len(logged), dtype=bool)
        if self._is_restarted:
            is_judged = logged >= self._first_logged
        by_log = self.at_logged(logged)
        own = (stamps - self._origin) / 1e9
        if not self._has_log:
            return own, is_judged
        if (stamps <= 0).any():
            return by_log, is_judged
        apart = np.abs(own - by_log)[is_judged]
        if len(apart) and float(np.median(apart)) > SAME_CLOCK:
            note = f"{name} has another clock than the joint states; the recorder's leads to theirs"
            if note not in self.notes:
                self.notes.append(note)
            return by_log, is_judged
        return own, is_judged

    def at_logged(self, logged: IntArray) -> FloatArray:
        """Times of the reference's clock at which the recorder got something [s]."""
        seconds = (logged - self._first_logged) / 1e9
        inside = np.interp(seconds, self._logged, self._stamped)
        before = np.minimum(seconds - self._logged[0], 0.0)
        after = np.maximum(seconds - self._logged[-1], 0.0)
        return inside + before + after


def _last_start(stamps: IntArray) -> int:
    """Index of the first row after a clock was set back for the last time; 0 when it never was.

    One late message is followed by stamps that go on as before; a restart is not.
    """
    for index in np.flatnonzero(np.diff(stamps) < -SET_BACK)[::-1]:
        after = stamps[index + 1 : index + 6]
        if float(np.median(after)) < float(stamps[index]) - SET_BACK:
            return int(index) + 1
    return 0
