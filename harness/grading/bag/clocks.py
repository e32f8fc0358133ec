"""One time line for all topics of a recording, whose senders may use different clocks."""

from __future__ import annotations

import numpy as np

from harness.core.types import BoolArray, FloatArray, IntArray
from harness.grading.bag.content import RecordedTrack

SET_BACK = 10**9
"""A clock that jumps back by more than this [ns] was restarted; a smaller jump is disorder."""
SAME_CLOCK = 0.5
"""Largest median difference between the stamps of one clock and the reference's clock [s]."""


class Timeline:
    """Seconds since the first sample of the reference, by its sender's clock.

    Stamps of other topics are used directly when they are from the same clock. Otherwise (one node
    with `use_sim_time`, the other without; two computers), the recorder's times convert between the
    clocks. Stamps may be in disorder. After a clock was set back, only the later part is used.

    Attributes:
        notes: Notes on the clocks.
    """

    def __init__(self, reference: RecordedTrack) -> None:
        self.notes: list[str] = []
        logged, stamps = reference.times()
        order = np.argsort(logged, kind="stable")
        logged, stamps = logged[order], stamps[order]
        if (stamps.min() == stamps.max() and len(stamps) > 1) or stamps.min() <= 0:
            stamps = logged
            self.notes.append(
                "the joint states have no stamps; the recorder's times are used instead"
            )
        begin = _last_start(stamps)
        self._is_restarted = begin > 0
        if begin:
            self.notes.append(
                "the clock was set back during the recording; only the part after that is judged"
            )
        self._first_logged = int(logged[begin])
        logged, stamps = logged[begin:], stamps[begin:]
        self._origin = int(stamps.min())
        self._logged = (logged - self._first_logged) / 1e9
        self._stamped = (stamps - self._origin) / 1e9
        self._has_log = bool(self._logged[-1] > 0)

    def rows(self, track: RecordedTrack, name: str = "") -> tuple[FloatArray, BoolArray]:
        """Time of every row [s], and whether the row is in the judged part; shape (N,) each.

        Args:
            name: Name of the topic in notes; empty where another call leaves the note.
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
            note = f"{name} and the joint states have different clocks; the recorder's aligns them"
            if name and note not in self.notes:
                self.notes.append(note)
            return by_log, is_judged
        return own, is_judged

    def at_logged(self, logged: IntArray) -> FloatArray:
        """Times of the reference's clock for times of the recorder's clock [s]."""
        seconds = (logged - self._first_logged) / 1e9
        inside = np.interp(seconds, self._logged, self._stamped)
        before = np.minimum(seconds - self._logged[0], 0.0)
        after = np.maximum(seconds - self._logged[-1], 0.0)
        return inside + before + after


def _last_start(stamps: IntArray) -> int:
    """Index of the first row after the last restart of the clock; 0 without a restart.

    After a single late message the stamps continue as before it; after a restart they do not.
    """
    for index in np.flatnonzero(np.diff(stamps) < -SET_BACK)[::-1]:
        after = stamps[index + 1 : index + 6]
        if float(np.median(after)) < float(stamps[index]) - SET_BACK:
            return int(index) + 1
    return 0
