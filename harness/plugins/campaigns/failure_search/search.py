"""One search from a scenario file to its smallest failures."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness.core.errors import HarnessError, SpecError
from harness.core.suggestion import did_you_mean
from harness.language.reading.load import load_scenario
from harness.plugins.campaigns.failure_search.closeness import failure_kind, failure_text
from harness.plugins.campaigns.failure_search.evaluator import Evaluator, OnRun, Sample
from harness.plugins.campaigns.failure_search.explore import Exploration, explore
from harness.plugins.campaigns.failure_search.shrink import shrink
from harness.plugins.campaigns.failure_search.space import Point, SearchSpace, search_space
from harness.plugins.campaigns.keys.search import SearchSpec
from harness.suite.cases import read_ahead
from harness.suite.discovery import UsageError
from harness.suite.header import read_header
from harness.suite.stream import Stream
from harness.suite.variation import Variation
from harness.suite.warm import WarmServer


@dataclass(frozen=True)
class SearchRequest:
    """What is searched, and how far.

    Attributes:
        overrides: Path -> value as YAML; they take precedence over what varies.
        case: Name of the parametrised case; empty where there is one.
        workers: Runs side by side.
        hard_cap: Wall seconds a run may take; None: the program's own.
    """

    file: Path
    overrides: Mapping[str, str]
    case: str
    settings: SearchSpec
    workers: int = 1
    hard_cap: float | None = None

    @classmethod
    def of(
        cls,
        file: Path,
        overrides: Mapping[str, str],
        case: str,
        settings: Mapping[str, Any],
        *,
        workers: int,
        hard_cap: float | None,
    ) -> SearchRequest:
        """What a file's `search` says.

        Args:
            settings: Settings that take precedence over the file's; those that are None do not.

        Raises:
            UsageError: The case or the expectation does not exist.
            SpecError: The file is invalid.
        """
        variation = read_header(file, overrides).variation
        scenario = load_scenario(
            file, {**_case_overrides(file, case, variation), **overrides}
        ).scenario
        given = {name: value for name, value in settings.items() if value is not None}
        search = scenario.search if isinstance(scenario.search, SearchSpec) else SearchSpec()
        stated = search.model_copy(update=given)
        names, minimise = scenario.expectation_names(), stated.minimise
        if minimise is not None and minimise not in names:
            known = f"; {did_you_mean(minimise, names, 'names')}" if names else ""
            raise UsageError(
                f"--minimise: no expectation of '{file}' is called '{minimise}'{known}"
            )
        return cls(file, overrides, case, stated, workers, hard_cap)


@dataclass(frozen=True)
class Failure:
    """A failure and its nearest neighbour of the nominal scenario.

    Attributes:
        nearest: The smallest change that fails in this way.
        shrink_runs: How many runs the shrinking took.
    """

    samples: tuple[Sample, ...]
    nearest: Sample
    shrink_runs: int

    @property
    def text(self) -> str:
        """What the smallest change makes fail, with its line."""
        return failure_text(self.nearest.result)


@dataclass(frozen=True)
class SearchResult:
    """What a search found.

    Attributes:
        request: What was searched, and how far.
        overrides: Path -> value as YAML that all runs have in common.
        space: The parameters that vary, with their nominal values.
        nominal: The run of the scenario as its file has it.
        failures: One for each kind of failure; if the nominal scenario fails, none.
        uncounted: Runs that are no evidence: invalid values, or overlaps where the file redraws.
    """

    request: SearchRequest
    overrides: Mapping[str, str]
    space: SearchSpace
    nominal: Sample
    exploration: Exploration
    failures: tuple[Failure, ...]
    uncounted: int = 0


def search(
    request: SearchRequest,
    server: WarmServer,
    *,
    stream: Stream | None = None,
    on_run: OnRun = lambda *_: None,
    on_stage: Callable[[str], None] = lambda _: None,
) -> SearchResult:
    """Search for failures of a scenario and shrink each kind of them.

    Args:
        on_run: Called with the number of each new run and its result.
        on_stage: Called with what the search does next.

    Raises:
        UsageError: Nothing varies, or a parametrised case must be named.
        SpecError: The file is invalid.
        HarnessError: The nominal scenario ends in an error.
    """
    variation, settings = read_header(request.file, request.overrides).variation, request.settings
    overrides = {**_case_overrides(request.file, request.case, variation), **request.overrides}
    space = search_space(request.file, variation, overrides)
    space = SearchSpace(
        tuple(each for each in space.parameters if each.path not in request.overrides)
    )
    if not space.parameters:
        raise UsageError(
            f"'{request.file}': nothing varies; give ranges with `randomize:` in the file"
        )
    server.prepare(read_ahead, frozenset())
    evaluate = Evaluator(
        request.file, space, overrides, settings.seed, server, request.workers,
        request.hard_cap, stream, on_run,
    )  # fmt: skip
    on_stage("the nominal scenario")
    [nominal] = evaluate([space.nominal])
    if nominal.result.outcome == "invalid":
        raise SpecError(nominal.result.problems)
    if nominal.result.outcome == "error":
        raise HarnessError(f"the nominal scenario ends in an error: {nominal.result.message}")
    if nominal.result.outcome == "failed":
        return SearchResult(
            request, overrides, space, nominal, Exploration((), (nominal,), {}, 1), ()
        )

    def is_counted(sample: Sample) -> bool:
        """Samples with overlapping objects are no evidence where the file draws them again."""
        is_overlapping = variation.redraw_overlaps and sample.result.overlap > 0
        return sample.result.outcome != "invalid" and not is_overlapping

    on_stage("searching")
    seed = variation.seed if settings.seed is None else settings.seed
    exploration = explore(space, evaluate, is_counted, settings, seed)
    if not exploration.start:
        problems = [each for s in exploration.samples for each in s.result.problems]
        if problems:
            raise SpecError(problems[:1])
        raise UsageError(
            f"'{request.file}': bodies overlap at the start of every sample, so that none counts;"
            " move them, widen the ranges, or leave out `redraw_overlaps`"
        )
    failures: list[Failure] = []
    for kind, samples in exploration.kinds.items():
        on_stage(f"shrinking: {failure_text(samples[0].result)}")
        failures.append(_shrunk(space, evaluate, kind, samples))
    uncounted = sum(not is_counted(each) for each in exploration.samples)
    return SearchResult(request, overrides, space, nominal, exploration, tuple(failures), uncounted)


def _case_overrides(file: Path, name: str, variation: Variation) -> dict[str, str]:
    cases = {each.name: each for each in variation.parametrized()}
    if name in cases:
        return dict(cases[name].overrides)
    known = ", ".join(list(cases)[:10])
    if not name:
        raise UsageError(f"'{file}' has {len(cases)} cases; name one of them with --case: {known}")
    raise UsageError(f"'{file}' has no case '{name}'; cases: {known or 'one'}")


def _shrunk(
    space: SearchSpace, evaluate: Evaluator, kind: str, samples: tuple[Sample, ...]
) -> Failure:
    before = len(evaluate.samples)

    def fails(points: Sequence[Point]) -> list[bool]:
        return [failure_kind(each.result) == kind for each in evaluate(points)]

    smallest = min((each.point for each in samples), key=space.size)
    nearest = shrink(space, smallest, fails)
    [sample] = evaluate([nearest])
    return Failure(samples, sample, len(evaluate.samples) - before)
