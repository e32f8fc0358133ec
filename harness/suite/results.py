"""The results of a suite by the index of their run; of those in a stream, only what counts."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterator, Mapping

from harness.recording.run import Outcome
from harness.reporting.result import CaseResult
from harness.suite.outcome import EXIT_CODES
from harness.suite.stream import Place, Stream, StreamEntry

OUTCOMES: tuple[Outcome, ...] = tuple(EXIT_CODES)
MISSING = len(OUTCOMES)


class Results(Mapping[int, CaseResult]):
    """Results by index, in the order of the indices.

    A suite with a stream keeps a few bytes of each result in memory and reads the rest when it is
    needed; without a stream, whole results are kept.

    Attributes:
        starts: Whether bodies overlap at the start, and the number of redraws, by the index of each
            sample that has either.
    """

    def __init__(self, count: int, stream: Stream | None = None) -> None:
        self.starts: dict[int, tuple[bool, int]] = {}
        self._stream = stream
        self._kept: dict[int, CaseResult] = {}
        self._outcomes = bytearray([MISSING]) * count
        self._offsets = array("Q", bytes(8 * count if stream else 0))
        self._lengths = array("I", bytes(4 * count if stream else 0))
        self._count = 0

    def keep(self, index: int, result: CaseResult, place: Place | None) -> None:
        """Take a result; the whole of one that stands in the stream is not kept."""
        self._count += index not in self
        self._outcomes[index] = OUTCOMES.index(result.outcome)
        if result.overlap > 0 or result.redraws:
            self.starts[index] = result.overlap > 0, result.redraws
        if place is not None:
            self._offsets[index], self._lengths[index] = place.offset, place.length
        else:
            self._kept[index] = result

    def drop(self, is_dropped: Callable[[int], bool]) -> list[Place]:
        """Forget some results.

        Returns:
            The places of those that stand in the stream.
        """
        dropped = list(filter(is_dropped, self))
        stored = [] if self._stream is None else [n for n in dropped if n not in self._kept]
        places = list(map(self._place, stored))
        for index in dropped:
            self._outcomes[index] = MISSING
            self._kept.pop(index, None)
            self.starts.pop(index, None)
            self._count -= 1
        return places

    def _place(self, index: int) -> Place:
        return Place(self._offsets[index], self._lengths[index])

    def __len__(self) -> int:
        return self._count

    def __iter__(self) -> Iterator[int]:
        return (index for index, outcome in enumerate(self._outcomes) if outcome != MISSING)

    def __contains__(self, index: object) -> bool:
        return isinstance(index, int) and self._outcomes[index] != MISSING

    def __getitem__(self, index: int) -> CaseResult:
        if index not in self:
            raise KeyError(index)
        stored = self.stored(index)
        return self._kept[index] if stored is None else stored.result

    def stored(self, index: int) -> StreamEntry | None:
        """The line of the stream that has a result; None where the result is in memory."""
        if self._stream is None or index in self._kept:
            return None
        return self._stream.entry(self._place(index))

    def outcomes(self) -> Iterator[tuple[int, Outcome]]:
        return ((index, OUTCOMES[self._outcomes[index]]) for index in self)
