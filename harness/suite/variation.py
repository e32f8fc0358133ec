"""The cases of a scenario file: each value of a grid in turn, named ones, random samples.

They follow from a few keys of the file; a file in which these have a mistake has one case, which
reports the problems.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import random
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from harness.core.lazy import LazySequence
from harness.core.variation import Parametrize, count_of

if TYPE_CHECKING:
    from harness.language.variation import CaseKeys, Distribution

LONGEST_NAME = 60  # [characters] of a value in a case's name


@dataclass(frozen=True)
class Case:
    """One instance of a scenario.

    Attributes:
        name: Unique in its file; empty when the file has one case.
        overrides: Dotted path in the file -> value as YAML.
        values: What varies, for tables: path -> value.
        group: Name of the parametrised case that a sample belongs to; samples share a rate.
        sample: Its number from 0; None when nothing is random.
        redraw: Draws it again; None where the file does not say so.
    """

    name: str = ""
    overrides: Mapping[str, str] = field(default_factory=dict[str, str])
    values: Mapping[str, Any] = field(default_factory=dict[str, Any])
    group: str = ""
    sample: int | None = None
    redraw: Redraw | None = None

    def with_overrides(self, overrides: Mapping[str, str]) -> Case:
        """The case with values that take precedence over its own, in every draw."""
        if self.sample is not None:  # the seed of all samples, which each draws its own from
            overrides = {path: text for path, text in overrides.items() if path != "seed"}
        redraw = None if self.redraw is None else replace(self.redraw, fixed=overrides)
        return replace(self, overrides={**self.overrides, **overrides}, redraw=redraw)


@dataclass(frozen=True)
class Variation:
    """What a file says of its cases.

    Attributes:
        parametrize: A grid, or named cases; None where there is none.
        randomize: Path -> distribution; empty where nothing is random.
        samples: How many of each parametrised case; 0: no samples.
        at_least: Success rate to be shown; None: every sample must pass.
        stop_early: Whether a sequential test may end the sampling.
        redraw_overlaps: Whether a sample is drawn again while objects overlap at the start.
        fixed: Values that options give in place of a case's own, path -> value.
    """

    parametrize: Parametrize | None = None
    randomize: Mapping[str, Distribution] = field(default_factory=dict[str, "Distribution"])
    samples: int = 0
    at_least: float | None = None
    confidence: float = 0.95
    stop_early: bool = True
    seed: int = 0
    redraw_overlaps: bool = False
    fixed: Mapping[str, Any] = field(default_factory=dict[str, Any])

    @classmethod
    def of(cls, keys: CaseKeys) -> Variation:
        """The variation that the keys of a scenario file say."""
        rate = keys.expect_rate
        variation = cls(
            parametrize=keys.parametrize,
            randomize=keys.randomize or {},
            samples=keys.sample_count,
            seed=keys.seed,
            redraw_overlaps=keys.redraw_overlaps is True,
        )
        if rate is None:
            return variation
        at_least, confidence = rate.at_least, rate.confidence
        return replace(
            variation, at_least=at_least, confidence=confidence, stop_early=rate.stop_early
        )

    @property
    def count(self) -> int:
        """How many cases there are, samples included."""
        return self.counted()

    def counted(self, samples: int | None = None) -> int:
        """How many cases `cases` gives, which may be too many for a sequence."""
        return max(1, self._sampled(samples)) * count_of(self.parametrize)

    def _sampled(self, samples: int | None) -> int:
        return samples if samples and self.samples else self.samples

    def cases(self, seed: int | None = None, samples: int | None = None) -> Cases:
        """Every case, in file order; samples of one parametrised case together.

        Args:
            seed: Instead of the file's.
            samples: Instead of the file's, where it has some.
        """
        base = self.seed if seed is None else seed
        return Cases(self, base, self._sampled(samples))

    def parametrized(self) -> Iterator[Case]:
        """The cases without their samples."""
        if self.parametrize is None:
            yield Case()
        elif isinstance(self.parametrize, Mapping):
            grid = self.parametrize
            labels = [_labels(values) for values in grid.values()]
            for combination in itertools.product(*(range(len(v)) for v in grid.values())):
                picked = list(zip(grid.items(), labels, combination, strict=True))
                chosen = {path: values[place] for (path, values), _, place in picked}
                yield self._case("-".join(names[place] for _, names, place in picked), chosen)
        else:
            taken: set[str] = set()
            for index, named in enumerate(self.parametrize):
                chosen = {path: value for path, value in named.items() if path != "id"}
                labels = [_label(value, place) for place, value in enumerate(chosen.values())]
                name = _plain_name(str(named.get("id") or "-".join(labels)))
                name = name if name and name not in taken else f"case{index}"
                taken.add(name)
                yield self._case(name, chosen)

    def _case(self, name: str, chosen: Mapping[str, Any]) -> Case:
        shown = {path: self.fixed.get(path, value) for path, value in chosen.items()}
        return Case(name, as_yaml(chosen), shown, name)

    def _sample(self, case: Case, index: int, base: int, draw: int = 0) -> Case:
        """A case with random values, and a seed of its own that everything random follows from."""
        seed = _seed(f"{base}:{case.name}:{index}{f':{draw}' if draw else ''}")
        rng = random.Random(seed)
        drawn = {path: each.draw(rng) for path, each in self.randomize.items()}
        return Case(
            name=_sample_name(case, index),
            overrides={**case.overrides, **as_yaml(drawn), "seed": str(seed)},
            values={**case.values, **{path: self.fixed.get(path, v) for path, v in drawn.items()}},
            group=case.name,
            sample=index,
            redraw=Redraw(self, case, index, base) if self.redraw_overlaps and not draw else None,
        )


@dataclass(frozen=True)
class Redraw:
    """Draws a sample again.

    Attributes:
        base: The seed of all samples.
        fixed: Overrides that no draw changes.
    """

    variation: Variation
    case: Case
    index: int
    base: int
    fixed: Mapping[str, str] = field(default_factory=dict[str, str])

    def __call__(self, draw: int) -> Case:
        """The sample as it is drawn next, by the number of the draw from 1."""
        drawn = self.variation._sample(self.case, self.index, self.base, draw)  # noqa: SLF001
        return drawn.with_overrides(self.fixed)


class Cases(LazySequence[Case]):
    """The cases of a file, each drawn when it is read, so that their number takes no memory."""

    def __init__(self, variation: Variation, base: int, samples: int) -> None:
        """Remember what the cases follow from.

        Args:
            samples: The number of samples of each parametrised case; 0: none are drawn.
        """
        self._variation = variation
        self._base = base
        self._samples = samples
        self._parametrized = tuple(variation.parametrized())
        super().__init__(len(self._parametrized) * max(1, samples), self._case)

    def _case(self, index: int) -> Case:
        case, sample = self._place(index)
        if sample is None:
            return case
        return self._variation._sample(case, sample, self._base)  # noqa: SLF001

    def name(self, index: int) -> str:
        """The name of a case, without drawing its values."""
        case, sample = self._place(index)
        return case.name if sample is None else _sample_name(case, sample)

    def group(self, index: int) -> str | None:
        """The name of the parametrised case that a case is a sample of; None where it is none."""
        case, sample = self._place(index)
        return None if sample is None else case.name

    def _place(self, index: int) -> tuple[Case, int | None]:
        """The parametrised case of an index, and the number of the sample."""
        if not self._samples:
            return self._parametrized[index], None
        place, sample = divmod(index, self._samples)
        return self._parametrized[place], sample


ONE_CASE = Variation()


def _sample_name(case: Case, index: int) -> str:
    return f"{case.name}-sample{index}" if case.name else f"sample{index}"


def as_yaml(values: Mapping[str, Any]) -> dict[str, str]:
    """Values as YAML, in which JSON is."""
    return {path: json.dumps(value, ensure_ascii=False) for path, value in values.items()}


def _seed(text: str) -> int:
    digest = hashlib.sha256(text.encode()).digest()
    return int.from_bytes(digest[:4], "big") & 0x7FFFFFFF


def _labels(values: Sequence[Any]) -> list[str]:
    """A label for each value; numbered where two would be the same."""
    labels = [_label(value, index) for index, value in enumerate(values)]
    if len(set(labels)) == len(labels):
        return labels
    return [f"{label}.{index}" for index, label in enumerate(labels)]


def _label(value: Any, index: int) -> str:
    if isinstance(value, dict | list) or value is None:
        return f"value{index}"
    if isinstance(value, bool):
        return str(value).lower()
    return _plain_name(str(value)) or f"value{index}"


def _plain_name(text: str) -> str:
    """A name that stands in ids and paths without quotes."""
    return re.sub(r"[^\w.+]+", "_", text).strip("_.")[:LONGEST_NAME]
