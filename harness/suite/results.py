"""The results of a suite by the index of their run; those in a stream are read when needed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from harness.recording.run import Outcome
from harness.reporting.result import CaseResult
from harness.suite.stream import Place, Stream, StreamEntry


class Results(Mapping[int, CaseResult]):
    """Results by index, in the order of the indices.

    A suite with a stream keeps the outcome and the place of each result in memory, and reads the
    rest when it is needed; without a stream, whole results are kept.

    Attributes:
        starts: Whether bodies overlap at the start, and the number of redraws, by the index of each
            sample that has either.
    """

    def __init__(self, stream: Stream | None = None) -> None:
        self.starts: dict[int, tuple[bool, int]] = {}
        self._stream = stream
        self._kept: dict[int, CaseResult | Place] = {}
        self._outcomes: dict[int, Outcome] = {}

    def keep(self, index: int, result: CaseResult, place: Place | None) -> None:
        """Take a result; the whole of one that stands in the stream is not kept."""
        self._kept[index] = place or result
        self._outcomes[index] = result.outcome
        if result.overlap > 0 or result.redraws:
            self.starts[index] = result.overlap > 0, result.redraws

    def drop(self, is_dropped: Callable[[int], bool]) -> list[Place]:
        """Forget some results.

        Returns:
            The places of those that stand in the stream.
        """
        dropped = list(filter(is_dropped, self))
        for index in dropped:
            self.starts.pop(index, None)
            del self._outcomes[index]
        kept = [self._kept.pop(index) for index in dropped]
        return [each for each in kept if isinstance(each, Place)]

    def __len__(self) -> int:
        return len(self._kept)

    def __iter__(self) -> Iterator[int]:
        return iter(sorted(self._kept))

    def __contains__(self, index: object) -> bool:
        return index in self._kept

    def __getitem__(self, index: int) -> CaseResult:
        kept = self._kept[index]
        return kept if isinstance(kept, CaseResult) else self._entry(kept).result

    def stored(self, index: int) -> StreamEntry | None:
        """The line of the stream that has a result; None where the result is in memory."""
        kept = self._kept[index]
        return None if isinstance(kept, CaseResult) else self._entry(kept)

    def _entry(self, place: Place) -> StreamEntry:
        assert self._stream is not None
        return self._stream.entry(place)

    def outcomes(self) -> Iterator[tuple[int, Outcome]]:
        return ((index, self._outcomes[index]) for index in self)
