"""The runs of one command: every case with its repetitions, and their results."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from harness.core.lazy import LazySequence
from harness.core.memory import free_memory
from harness.recording.run import Outcome
from harness.reporting.progress_events import ProgressEvent
from harness.reporting.result import CaseResult
from harness.reporting.sampled import SampledRate, with_starts
from harness.reporting.suite.record import SuiteCase, SuiteRecord
from harness.session.run_request import RunRequest
from harness.suite.cases import Watcher, ignore_progress, run_here, run_isolated
from harness.suite.installation import installation
from harness.suite.outcome import EXIT_CODES, INTERRUPTED_EXIT_CODE, exit_code
from harness.suite.plan import Plan
from harness.suite.request import SuiteRequest
from harness.suite.results import Results
from harness.suite.sampling import Sampling
from harness.suite.stream import Place, Stream
from harness.suite.warm import WarmServer

OnResult = Callable[[int, CaseResult], None]

CASES_BETWEEN = 100  # cases after which memory is given back: it costs what a tenth of one does


class SuiteRun:
    """Runs planned cases and keeps their results.

    Attributes:
        jobs: Their runs: with repetitions, `repeat` of each case side by side.
        results: The results by index into `jobs`; of samples, those that count.
        resumed: How many results are from an earlier run.
        is_interrupted: Whether Ctrl-C or SIGTERM ended it early.
        missing_parts: Why a suite that was merged from parts is incomplete, one sentence each.
        unfinished: The last event of each run that has begun and not ended, by index into `jobs`.
    """

    def __init__(self, plan: Plan, request: SuiteRequest, files: Sequence[Path] = ()) -> None:
        self.plan = plan
        self.files = files
        self.jobs = LazySequence(len(plan) * request.repeat, self._job)
        self.results = Results()
        self.resumed = 0
        self.is_interrupted = False
        self.missing_parts: tuple[str, ...] = ()
        self.unfinished: dict[int, ProgressEvent] = {}
        self._request = request
        self._stream: Stream | None = None
        self._wall = 0.0
        self._sampling = Sampling(plan, is_part=self.is_part)

    def _job(self, index: int) -> RunRequest:
        """A run; of several runs of a case only the first one is reported."""
        case, repetition = divmod(index, self._request.repeat)
        job = self.plan[case].job
        return replace(job, report_dir=None) if repetition else job

    def collect(
        self,
        server: WarmServer,
        watch: Watcher = ignore_progress,
        on_result: OnResult = lambda *_: None,
    ) -> None:
        """Run what is requested; an interruption keeps the results that there are.

        Args:
            server: Open, unless the cases run in this process.

        Raises:
            HarnessError: The stream cannot be written.
        """

        def watched(index: int, event: ProgressEvent) -> None:
            self.unfinished[index] = event
            watch(index, event)

        begin = time.monotonic()
        try:
            self._open_stream()
            for count, (index, result) in enumerate(self._arriving(server, watched), 1):
                self.unfinished.pop(index, None)
                on_result(index, self._keep(index, result))
                if count % CASES_BETWEEN == 0:
                    free_memory()
        except KeyboardInterrupt:
            self.is_interrupted = True
        self._wall = 0.0 if self.resumed else time.monotonic() - begin
        self.count()

    def take(self, index: int, result: CaseResult, place: Place | None) -> None:
        """Take a result; `place` is where it stands in the stream."""
        if self._is_sampled:
            self._sampling.note(index, result.outcome, result.digest)
        self.results.keep(index, result, place)

    def read_from(self, stream: Stream) -> None:
        self._stream = stream
        self.results = Results(stream)

    def count(self) -> None:
        """Leave out the results of samples after an early stop, also for readers of the stream.

        Raises:
            HarnessError: The stream cannot be written.
        """
        dropped = self.results.drop(self._sampling.is_needless) if self._is_sampled else []
        if self._stream is not None:
            self._stream.leave_out(dropped)

    @property
    def is_part(self) -> bool:
        """Whether the plan is one part of a suite."""
        return self._request.is_part

    @property
    def _is_sampled(self) -> bool:
        """Repetitions are compared with each other, not counted as samples."""
        return self._request.repeat == 1

    def _arriving(self, server: WarmServer, watch: Watcher) -> Iterator[tuple[int, CaseResult]]:
        how = self._request
        if how.in_process:
            return run_here(self.jobs, watch=watch, is_needless=self.is_needless)
        if how.hooks.execute is not None:
            files = [each.file for each in self.plan.files]
            return how.hooks.execute(self.jobs, files, self.is_needless)
        return run_isolated(
            self.jobs,
            server,
            workers=how.workers,
            hard_cap=how.hard_cap,
            watch=watch,
            is_needless=self.is_needless,
        )

    def _open_stream(self) -> None:
        """Open where results go as they come; those of an earlier run are taken from there."""
        how = self._request
        is_whole = how.repeat == 1 and (len(self.plan) > 1 or how.is_part)
        root = how.report_root if how.resume or is_whole else None
        if root is None and (how.repeat > 1 or len(self.jobs) == 1):
            return
        stream = Stream(root, resume=how.resume)
        installation()  # now, while the modules of a run are imported in another process
        self.read_from(stream)
        for index, job in enumerate(self.jobs if how.resume else ()):
            if known := stream.known(job):
                place, result = known
                self.take(index, result, place)
                self.resumed += 1

    def _keep(self, index: int, result: CaseResult) -> CaseResult:
        """Take a result that was computed, and write it into the stream."""
        place = None
        if self._stream is not None:
            planned, job = self.plan[index // self._request.repeat], self.jobs[index]
            values = {**planned.values, **result.values}
            place = self._stream.write(job, result, values, planned.header.tags)
        result = replace(result, inputs={})
        self.take(index, result, place)
        return result

    def is_needless(self, index: int) -> bool:
        """Whether a run's result is known, or would not count."""
        return index in self.results or (self._is_sampled and self._sampling.is_needless(index))

    # -- results -------------------------------------------------------------------------------

    @property
    def missing(self) -> int:
        """Runs that an interruption left undone."""
        return sum(not self.is_needless(index) for index in range(len(self.jobs)))

    @property
    def rates(self) -> list[SampledRate]:
        """Success rates of the parametrised cases that are sampled."""
        if not self._is_sampled:
            return []
        starts: dict[tuple[str, str] | None, list[tuple[bool, int]]] = {}
        for index, start in self.results.starts.items():
            starts.setdefault(self.plan[index].rate_key, []).append(start)
        return [
            replace(group, rate=with_starts(group.rate, starts.get((group.file, group.group), [])))
            for group in self._sampling.groups()
        ]

    @property
    def files_text(self) -> str:
        """How many files were found, have a selected case, and were run."""
        collected = {each.file for each in self.plan}
        ran = {self.plan[index // self._request.repeat].file for index in self.results}
        return f"{len(self.files)} files found, {len(collected)} collected, {len(ran)} run"

    @property
    def record(self) -> SuiteRecord:
        """What the suite's files are written from."""
        counted = list(self.results)
        cases = LazySequence(len(counted), lambda index: self.case(counted[index]))
        outcome, parts = self.outcome, self.missing_parts
        return SuiteRecord(outcome, cases, self.rates, self.is_interrupted, parts, wall=self._wall)

    def case(self, index: int) -> SuiteCase:
        """A result as the files of a suite show it, by index into `jobs`."""
        planned = self.plan[index // self._request.repeat]
        header, stored = planned.header, self.results.stored(index)
        if stored is not None:
            result, values = stored.result, stored.values
        else:
            result = self.results[index]
            values = {**planned.values, **result.values}
        options = self._request.options
        return SuiteCase(result, values, header.tags, header.verifies, options=options)

    def failures(self) -> Iterator[CaseResult]:
        return (self.results[i] for i, outcome in self.results.outcomes() if outcome != "passed")

    def repetitions(self) -> list[list[CaseResult]]:
        """Results of the same case together, in file order."""
        together: dict[int, list[CaseResult]] = {}
        for index, result in self.results.items():
            together.setdefault(index // self._request.repeat, []).append(result)
        return list(together.values())

    @property
    def outcome(self) -> Outcome:
        """The gravest outcome; repetitions that differ have failed."""
        found = self.results.outcomes()
        is_same = True
        if self._is_sampled:
            outcomes: set[Outcome] = self._sampling.outcomes(found)
        else:
            outcomes = {outcome for _, outcome in found}
            is_same = all(
                len({(result.outcome, result.digest) for result in runs}) == 1
                for runs in self.repetitions()
            )
        gravest: Outcome = max(outcomes or {"passed"}, key=EXIT_CODES.__getitem__)
        return "failed" if gravest == "passed" and not is_same else gravest

    @property
    def exit_code(self) -> int:
        if self.is_interrupted:
            return INTERRUPTED_EXIT_CODE
        return exit_code(["error"] if self.missing_parts else [self.outcome])
