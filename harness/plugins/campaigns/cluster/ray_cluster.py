"""Run cases on a Ray cluster: batches out, results back, a bounded number of both in memory."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from harness.core.errors import HarnessError
from harness.core.extras import install_command
from harness.core.registry import VARIABLE as PLUGINS
from harness.plugins.campaigns.cluster.batch import (
    Batch,
    BatchResult,
    Files,
    run_batch,
    unpack_report,
)
from harness.plugins.campaigns.cluster.named_files import named_files
from harness.reporting.result import CaseResult
from harness.session.run_request import RunRequest
from harness.suite.cases import Chooser, error_result, never_needless
from harness.suite.discovery import UsageError
from harness.suite.installation import installation, search_environment

LOCAL = "ray"
CLIENT = "ray://"
BATCH_SECONDS = 3.0  # of wall time: long compared with the millisecond that Ray adds
MOST_CASES = 100  # largest number of cases in a batch
BATCHES_FOR_EACH_PROCESS = 2  # that wait or run; more are not made yet
RETRIES = 3  # how often Ray starts a batch again whose process or node ended

BatchFunction = Callable[[Batch, Files], BatchResult]

PATIENCE = 1.0  # [s], then Ctrl-C is looked at again


def check_cluster(name: str) -> None:
    """See that `--on` names a cluster, and that Ray is installed.

    Raises:
        UsageError: It does not, or Ray is missing.
    """
    if name != LOCAL and not (name.startswith(CLIENT) and len(name) > len(CLIENT)):
        raise UsageError(f"--on '{name}': write ray, or ray://HOST:PORT of a cluster")
    try:
        import ray  # noqa: F401  # pyright: ignore[reportMissingImports, reportUnusedImport]
    except ImportError:
        raise UsageError(
            "--on ray needs Ray, which is no part of this installation:"
            f" {install_command('cluster')}"
        ) from None


class RayCluster:
    """Cases that run on a Ray cluster; a process or node that ends costs time and no case.

    Attributes:
        processors: The processor families of the nodes that have returned results.
    """

    def __init__(
        self,
        jobs: Sequence[RunRequest],
        *,
        hard_cap: float | None = None,
        is_needless: Chooser = never_needless,
        function: BatchFunction = run_batch,
    ) -> None:
        """Run nothing yet.

        Args:
            jobs: The cases, of which only those under way are in memory.
            hard_cap: Wall seconds a case may take; None: the program's own.
            is_needless: Called with each index before its case is sent; a needless one is skipped.
            function: What a process of a node calls; importable there by its name.
        """
        self.processors: set[str] = set()
        self._jobs = jobs
        self._hard_cap = hard_cap
        self._is_needless = is_needless
        self._function = function
        self._next = 0
        self._alone: list[int] = []  # cases of batches that failed, which run alone
        self._seconds, self._cases = 0.0, 0

    def run(
        self, name: str, workers: int, files: Sequence[Path]
    ) -> Iterator[tuple[int, CaseResult]]:
        """Make batches of about the same duration, and collect their results.

        Args:
            name: `ray` for processes on this machine, or for the cluster that RAY_ADDRESS names;
                else `ray://HOST:PORT`.

        Yields:
            (index into the cases, result) in the order in which batches end. The reports are in
            their folders on this machine.

        Raises:
            HarnessError: The cluster cannot be reached, or a node has another installation.
        """
        if all(self._is_needless(index) for index in range(len(self._jobs))):
            return
        with _connected(name, workers) as ray:
            task = ray.remote(num_cpus=1, max_retries=RETRIES)(self._function)
            sent = ray.put(_files_of(files))
            most = BATCHES_FOR_EACH_PROCESS * int(ray.cluster_resources().get("CPU", 1))
            running: dict[Any, Batch] = {}
            try:
                while True:
                    while len(running) < most and (batch := self._batch()):
                        running[task.remote(batch, sent)] = batch
                    if not running:
                        return
                    ready, _ = ray.wait(list(running), num_returns=1, timeout=PATIENCE)
                    for reference in ready:
                        yield from self._results(ray, reference, running.pop(reference))
            finally:
                for reference in running:
                    ray.cancel(reference, force=True)

    def _batch(self) -> Batch | None:
        """The next cases; None when all are under way."""
        indices: list[int] = []
        if self._alone:
            indices.append(self._alone.pop(0))
        while self._next < len(self._jobs) and len(indices) < self._size() and not self._alone:
            if not self._is_needless(self._next):
                indices.append(self._next)
            self._next += 1
        cases = tuple((index, self._jobs[index]) for index in indices)
        return Batch(cases, installation(), self._hard_cap) if cases else None

    def _size(self) -> int:
        """The number of cases that take `BATCH_SECONDS`, estimated from the cases so far."""
        if not self._cases:
            return 1
        return max(1, min(MOST_CASES, round(BATCH_SECONDS * self._cases / self._seconds)))

    def _results(self, ray: Any, reference: Any, batch: Batch) -> Iterator[tuple[int, CaseResult]]:
        try:
            done: BatchResult = ray.get(reference)
        except ray.exceptions.RayError as error:
            if len(batch.cases) > 1:  # one of them may be to blame
                self._alone += [index for index, _ in batch.cases]
                return
            index, job = next(iter(batch.cases))
            yield index, error_result(job, f"the cluster lost the case: {error}")
            return
        if done.refusal:
            raise HarnessError(
                f"{done.refusal}; results of different installations are not mixed: install the"
                " same version everywhere"
            )
        self.processors.add(done.processor)
        self._seconds, self._cases = self._seconds + done.seconds, self._cases + len(batch.cases)
        for index, result, packed in done.results:
            yield index, self._reported(index, result, packed)

    def _reported(self, index: int, result: CaseResult, packed: bytes) -> CaseResult:
        folder = self._jobs[index].report_dir
        if not packed or folder is None:
            return result
        try:
            unpack_report(packed, folder)
        except OSError as error:
            why = f"the report cannot be written to '{folder}': {error.strerror or error}"
            return replace(error_result(self._jobs[index], why), seed=result.seed)
        return result


def _files_of(files: Sequence[Path]) -> Files:
    """Every file that the cases and the plug-ins name."""
    contents: dict[str, bytes] = {}
    for file in files:
        for path, content in named_files(file):
            contents[os.path.abspath(path)] = content  # noqa: PTH100 - links stay as they are
    environment = search_environment()
    for plugin in environment.get(PLUGINS, "").split(os.pathsep):
        if plugin.endswith(".py"):
            contents[plugin] = Path(plugin).read_bytes()
    return Files(contents, str(Path.cwd()), environment)


def _initialize(ray: Any, options: dict[str, Any]) -> None:
    """Connect to Ray; three times, because a client's server sometimes dies at its start.

    Source: ray-project/ray, issue 63202.
    """
    for further_tries in (2, 1, 0):
        try:
            ray.init(**options)
        except ConnectionAbortedError:
            if not further_tries:
                raise
            ray.shutdown()
        else:
            return


@contextmanager
def _connected(name: str, workers: int) -> Iterator[Any]:
    """Ray, connected; what Ray does with signals is undone."""
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")
    import ray  # pyright: ignore[reportMissingImports]

    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    handlers = {number: signal.getsignal(number) for number in numbers}
    address = os.environ.get("RAY_ADDRESS") if name == LOCAL else name
    is_local = address in (None, "", "local")
    options: dict[str, Any] = {"log_to_driver": False, "configure_logging": False}
    if is_local:
        options |= {
            "address": "local",
            "num_cpus": workers,
            "include_dashboard": False,
            "_node_ip_address": "127.0.0.1",
        }
    else:
        options |= {"address": address}
    try:
        _initialize(ray, options)
    except Exception as error:  # Ray raises this class itself, and whatever its folder does
        where = "on this machine" if is_local else f"at '{address}'"
        raise HarnessError(f"the Ray cluster {where} cannot be reached: {error}") from error
    try:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        yield ray
    finally:
        ray.shutdown()
