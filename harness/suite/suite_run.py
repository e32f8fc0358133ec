"""The runs of one command: every case with its repetitions, and their results."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from harness.recording.run import Outcome
from harness.reporting.result import CaseResult, ProgressEvent
from harness.reporting.sampled import SampledRate, with_starts
from harness.reporting.suite.record import SuiteCase, SuiteRecord
from harness.suite.cases import Watcher, ignore_progress, run_here, run_isolated
from harness.suite.outcome import EXIT_CODES, INTERRUPTED_EXIT_CODE, exit_code
from harness.suite.plan import PlannedCase
from harness.suite.repetitions import Repetitions
from harness.suite.sampling import Sampling
from harness.suite.stream import Stream
from harness.suite.warm import WarmServer

OnResult = Callable[[int, CaseResult], None]


@dataclass(frozen=True)
class SuiteOptions:
    """How a suite is run.

    Attributes:
        workers: Cases side by side.
        repeat: Runs of each case; only the first is reported.
        in_process: Without a process for each case, for debuggers.
        hard_cap: Wall seconds a case may take; None: the program's own.
        stream: Folder that results are written to as they come; None: nowhere.
        resume: Whether results that are there are taken instead of computed.
        is_part: Whether the plan is one part of a suite, whose rates are decided after a merge.
        cluster: The cluster that runs the cases; empty for this machine.
    """

    workers: int = 1
    repeat: int = 1
    in_process: bool = False
    hard_cap: float | None = None
    stream: Path | None = None
    resume: bool = False
    is_part: bool = False
    cluster: str = ""


class SuiteRun:
    """Runs planned cases and keeps their results.

    Attributes:
        plan: Cases, in file order.
        files: The scenario files that were found.
        jobs: Their runs: with repetitions, `repeat` of each case side by side.
        results: The results by index into `jobs`; of samples, those that count.
        resumed: How many results are from an earlier run.
        is_interrupted: Whether Ctrl-C or SIGTERM ended it early.
        missing_parts: Why a suite that was merged from parts is incomplete, one sentence each.
        processors: Processor families of the cluster's nodes; digests are comparable within one.
        unfinished: The last event of each run that has begun and not ended, by index into `jobs`.
    """

    def __init__(
        self, plan: Sequence[PlannedCase], how: SuiteOptions, files: Sequence[Path] = ()
    ) -> None:
        self.plan = plan
        self.files = files
        self._repetitions = (
            Repetitions([each.job for each in plan], how.repeat) if how.repeat > 1 else None
        )
        self.jobs = self._repetitions.jobs if self._repetitions else [each.job for each in plan]
        self.results: dict[int, CaseResult] = {}
        self.resumed = 0
        self.is_interrupted = False
        self.missing_parts: tuple[str, ...] = ()
        self.processors: set[str] = set()
        self.unfinished: dict[int, ProgressEvent] = {}
        self._how = how
        self._sampling = Sampling(plan, is_part=how.is_part)

    def collect(
        self,
        server: WarmServer,
        watch: Watcher = ignore_progress,
        on_result: OnResult = lambda *_: None,
    ) -> None:
        """Run what is requested; an interruption keeps the results that there are.

        Args:
            server: Open, unless the cases run in this process.
            watch: Called with the events of running cases.
            on_result: Called with the result of each case that ends.

        Raises:
            HarnessError: The stream cannot be written.
        """

        def watched(index: int, event: ProgressEvent) -> None:
            self.unfinished[index] = event
            watch(index, event)

        try:
            with ExitStack() as stack:
                if self._repetitions is not None:
                    stack.enter_context(self._repetitions)
                stream = self._stream(stack)
                for index, result in self._arriving(server, watched):
                    self.unfinished.pop(index, None)
                    kept = self._take(index, result)
                    if stream is not None:
                        tags = self.plan[index // self._how.repeat].header.tags
                        stream.write(self.jobs[index], kept, self.values(index), tags)
                    on_result(index, kept)
        except KeyboardInterrupt:
            self.is_interrupted = True
        self._count()

    def take_all(self, results: Mapping[int, CaseResult]) -> None:
        """Take results that were computed elsewhere, by index into `jobs`, instead of running."""
        for index in sorted(results):
            self._take(index, results[index])
        self._count()

    def _count(self) -> None:
        """Leave out the results of samples after an early stop."""
        counted = self._sampling.counted(self.results) if self._is_sampled else self.results
        self.results = dict(sorted(counted.items()))

    @property
    def is_part(self) -> bool:
        """Whether the plan is one part of a suite."""
        return self._how.is_part

    @property
    def _is_sampled(self) -> bool:
        """Repetitions are compared with each other, not counted as samples."""
        return self._repetitions is None

    def _arriving(self, server: WarmServer, watch: Watcher) -> Iterator[tuple[int, CaseResult]]:
        how = self._how
        if how.in_process:
            return run_here(self.jobs, watch=watch, is_needless=self.is_needless)
        if how.cluster:
            from harness.suite.ray_cluster import RayCluster  # the extra `cluster`

            cluster = RayCluster(how.cluster, how.workers)
            self.processors = cluster.processors
            return cluster.run(self.jobs, hard_cap=how.hard_cap, is_needless=self.is_needless)
        return run_isolated(
            self.jobs,
            server,
            workers=how.workers,
            hard_cap=how.hard_cap,
            watch=watch,
            is_needless=self.is_needless,
        )

    def _stream(self, stack: ExitStack) -> Stream | None:
        """Where results go as they come; those of an earlier run are taken from there."""
        if self._how.stream is None:
            return None
        stream = stack.enter_context(closing(Stream(self._how.stream, resume=self._how.resume)))
        for index, job in enumerate(self.jobs):
            known = stream.known(job)
            if known is not None:
                self._take(index, known)
                self.resumed += 1
        return stream

    def _take(self, index: int, result: CaseResult) -> CaseResult:
        if self._repetitions is not None:
            result = self._repetitions.take(index, result)
        else:
            self._sampling.note(index, result.outcome, result.digest)
        self.results[index] = result
        return result

    def is_needless(self, index: int) -> bool:
        """Whether a run's result is known, or would not count."""
        return index in self.results or (self._is_sampled and self._sampling.is_needless(index))

    # -- results -------------------------------------------------------------------------------

    @property
    def differences(self) -> dict[int, str]:
        """Of repetitions: index into `jobs` -> where a run parts from the first of its case."""
        return self._repetitions.differences if self._repetitions is not None else {}

    @property
    def missing(self) -> int:
        """Runs that an interruption left undone."""
        return sum(not self.is_needless(index) for index in range(len(self.jobs)))

    @property
    def rates(self) -> list[SampledRate]:
        """Success rates of the parametrised cases that are sampled."""
        if not self._is_sampled:
            return []
        starts: dict[tuple[str, str] | None, list[CaseResult]] = {}
        for index, result in self.results.items():
            starts.setdefault(self.plan[index].rate_key, []).append(result)
        return [
            replace(group, rate=with_starts(group.rate, starts.get((group.file, group.group), [])))
            for group in self._sampling.groups()
        ]

    @property
    def files_text(self) -> str:
        """How many files were found, have a selected case, and were run."""
        collected = {each.job.file for each in self.plan}
        ran = {self.jobs[index].file for index in self.results}
        return f"{len(self.files)} files found, {len(collected)} collected, {len(ran)} run"

    def values(self, index: int) -> Mapping[str, Any]:
        """What varies in a run, as it was drawn at last."""
        drawn = self.results[index].values if index in self.results else {}
        return {**self.plan[index // self._how.repeat].values, **drawn}

    @property
    def record(self) -> SuiteRecord:
        """What the suite's files are written from."""
        cases: list[SuiteCase] = []
        for index, result in self.results.items():
            case = self.plan[index // self._how.repeat]
            cases.append(
                SuiteCase(result, self.values(index), case.header.tags, case.header.verifies)
            )
        return SuiteRecord(self.outcome, cases, self.rates, self.is_interrupted, self.missing_parts)

    def repetitions(self) -> list[list[CaseResult]]:
        """Results of the same case together, in file order."""
        together: dict[int, list[CaseResult]] = {}
        for index, result in self.results.items():
            together.setdefault(index // self._how.repeat, []).append(result)
        return list(together.values())

    @property
    def outcome(self) -> Outcome:
        """The gravest outcome; repetitions that differ have failed."""
        outcomes: list[Outcome] = (
            self._sampling.outcomes(self.results)
            if self._is_sampled
            else [result.outcome for result in self.results.values()]
        )
        gravest: Outcome = "passed"
        for each in outcomes:
            gravest = each if EXIT_CODES[each] > EXIT_CODES[gravest] else gravest
        is_same = all(
            len({(result.outcome, result.digest) for result in runs}) == 1
            for runs in self.repetitions()
        )
        return "failed" if gravest == "passed" and not is_same else gravest

    @property
    def exit_code(self) -> int:
        """Of the command."""
        if self.is_interrupted:
            return INTERRUPTED_EXIT_CODE
        return exit_code(["error"] if self.missing_parts else [self.outcome])
