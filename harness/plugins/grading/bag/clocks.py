"""One time line for all topics of a recording, whose senders may use different clocks."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from harness.core.types import BoolArray, FloatArray, IntArray
from harness.plugins.grading.bag.content import RecordedTrack

SET_BACK = 10**9  # [ns]; a clock that jumps back by more was restarted, by less is disorder
SAME_CLOCK = 0.5
"""Largest median difference between the stamps of one clock and the reference's clock [s]; also the
first stamp after 0 of a simulation that began at 0."""
NANOSECOND = 9  # decimals of times [s], as of stamps: equal stamps are equal times


class Timeline:
    """Seconds since the first sample of the reference, by its sender's clock.

    Stamps of other topics are used directly when they are from the same clock. Otherwise (one node
    with `use_sim_time`, the other without; two computers), the recorder's times convert between the
    clocks. Stamps may be in disorder. After a clock was set back, only the later part is used. A
    message without a stamp has the time at which the recorder received it.
    """

    def __init__(self, reference: RecordedTrack) -> None:
        self.notes: list[str] = []
        logged, stamps = reference.times()
        order = np.argsort(logged, kind="stable")
        logged, stamps = logged[order], stamps[order]
        missing = _without_stamp(stamps)
        if (stamps.min() == stamps.max() and len(stamps) > 1) or _are_most(missing):
            stamps = logged
            self.notes.append(
                "the joint states have no stamps; the recorder's times are used instead"
            )
        elif missing.any():
            stamps[missing] = np.interp(logged[missing], logged[~missing], stamps[~missing])
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
        by_log = np.round(self.at_logged(logged), NANOSECOND)
        own = np.round((stamps - self._origin) / 1e9, NANOSECOND)
        if not self._has_log:
            return own, is_judged
        missing = _without_stamp(stamps)
        if _are_most(missing):
            return by_log, is_judged
        apart = np.abs(own - by_log)[is_judged & ~missing]
        if len(apart) and float(np.median(apart)) > SAME_CLOCK:
            if name:
                self._note(
                    f"{name} and the joint states have different clocks; the recorder's aligns them"
                )
            return by_log, is_judged
        if name and missing.any():
            count = f"{int(missing.sum())} of {len(missing)} messages of {name}"
            self._note(f"{count} have no stamp; the recorder's times are used for them")
        return np.where(missing, by_log, own), is_judged

    def recorded(self, tracks: Iterable[RecordedTrack]) -> tuple[float, float]:
        """When the recorder received the first and the last message of the judged part [s]."""
        if not self._has_log:
            return -np.inf, np.inf
        logged = np.concatenate([track.times()[0] for track in tracks])
        logged = logged[logged >= self._first_logged] if self._is_restarted else logged
        first, last = self.at_logged(np.array([logged.min(), logged.max()])).tolist()
        return first, last

    def _note(self, note: str) -> None:
        if note not in self.notes:
            self.notes.append(note)

    def at_logged(self, logged: IntArray) -> FloatArray:
        """Times of the reference's clock for times of the recorder's clock [s]."""
        seconds = (logged - self._first_logged) / 1e9
        inside = np.interp(seconds, self._logged, self._stamped)
        before = np.minimum(seconds - self._logged[0], 0.0)
        after = np.maximum(seconds - self._logged[-1], 0.0)
        return inside + before + after


def _without_stamp(stamps: IntArray) -> BoolArray:
    """Rows with a stamp of 0, except where a simulation begins: the next stamps follow from 0."""
    indices = np.where(stamps > 0, np.arange(len(stamps)), len(stamps))
    following = np.minimum.accumulate(indices[::-1])[::-1]
    next_stamps = np.append(stamps, np.iinfo(np.int64).max)[following]
    return (stamps <= 0) & (next_stamps > SAME_CLOCK * 1e9)


def _are_most(rows: BoolArray) -> bool:
    return 2 * int(rows.sum()) > len(rows)


def _last_start(stamps: IntArray) -> int:
    """Index of the first row after the last restart of the clock; 0 without a restart.

    After a single late message the stamps continue as before it; after a restart they do not.
    """
    for index in np.flatnonzero(np.diff(stamps) < -SET_BACK)[::-1]:
        after = stamps[index + 1 : index + 6]
        if float(np.median(after)) < float(stamps[index]) - SET_BACK:
            return int(index) + 1
    return 0
