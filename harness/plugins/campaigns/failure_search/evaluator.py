"""Runs the scenario at points of the search space, each point once."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from harness.plugins.campaigns.failure_search.space import Point, SearchSpace
from harness.reporting.result import CaseResult
from harness.session.run_request import RunRequest
from harness.suite.cases import run_isolated
from harness.suite.stream import Stream
from harness.suite.warm import WarmServer

OnRun = Callable[[int, CaseResult], None]


@dataclass(frozen=True)
class Sample:
    """A run at a point."""

    point: Point
    result: CaseResult


@dataclass
class Evaluator:
    """Runs points in batches; the results depend neither on the workers nor on the order.

    Attributes:
        overrides: Path -> value as YAML, the same in every run.
        seed: Seed that replaces the file's seed; every run has the same one.
        workers: Runs side by side.
        hard_cap: Wall seconds a run may take; None: the program's own.
        stream: Takes the results as they come, and has those of an earlier search.
        on_run: Called with the number of each new run and its result.
        samples: Every sample so far, in the order of the runs, by its point as JSON.
    """

    file: Path
    space: SearchSpace
    overrides: Mapping[str, str]
    seed: int | None
    server: WarmServer
    workers: int = 1
    hard_cap: float | None = None
    stream: Stream | None = None
    on_run: OnRun = lambda *_: None
    samples: dict[str, Sample] = field(default_factory=dict[str, Sample])

    def __call__(self, points: Sequence[Point]) -> list[Sample]:
        """Run every point that has not been run, and return the samples in the points' order."""
        keys = [json.dumps(point) for point in points]
        new = {key: p for key, p in zip(keys, points, strict=True) if key not in self.samples}
        points_run = list(new.values())
        jobs = [self._job(point, len(self.samples) + i) for i, point in enumerate(points_run)]
        results: dict[int, CaseResult] = {}
        for index, job in enumerate(jobs):
            if self.stream is not None and (known := self.stream.known(job)):
                results[index] = self.stream.entry(known[0]).result
        for index, result in run_isolated(
            jobs,
            self.server,
            workers=self.workers,
            hard_cap=self.hard_cap,
            is_needless=results.__contains__,
        ):
            results[index] = result
            if self.stream is not None:
                self.stream.write(jobs[index], result, self.space.values(points_run[index]))
            self.on_run(len(self.samples) + len(results), result)
        for index, (key, point) in enumerate(new.items()):
            self.samples[key] = Sample(point, results[index])
        return [self.samples[key] for key in keys]

    def _job(self, point: Point, number: int) -> RunRequest:
        overrides = {**self.overrides, **self.space.overrides(point)}
        return RunRequest(self.file, overrides, self.seed, case=f"run{number}")
