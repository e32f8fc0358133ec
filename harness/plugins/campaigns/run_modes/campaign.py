"""`harness run` with `--shard`, `--conditions` and `--on`: campaigns on several machines."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.cli.output import complain, say
from harness.cli.run_mode import RunCall, RunFiles, RunMode
from harness.cli.suite_output import has_page
from harness.suite.discovery import UsageError
from harness.suite.hooks import Execute, SuiteHooks

if TYPE_CHECKING:
    from harness.plugins.campaigns.conditions import Conditions
    from harness.reporting.result import CaseResult
    from harness.reporting.suite.columns import Columns
    from harness.reporting.suite.write import History
    from harness.session.run_request import RunRequest
    from harness.suite.cases import Chooser
    from harness.suite.request import SuiteRequest
    from harness.suite.suite_run import SuiteRun


class CampaignMode(RunMode):
    """Run a part of a suite, the samples of another run, or cases on a cluster."""

    name: ClassVar[str] = "campaign"

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add `--shard`, `--conditions` and `--on`."""
        add = command.add_argument
        text = (
            "run part N of COUNT of the suite, or with 'auto' the part that SLURM, Kubernetes or"
            " GitLab names; `harness merge` joins the parts"
        )
        add("--shard", metavar="N/COUNT", default="", help=text)
        text = (
            "run the samples of an earlier run, by its conditions.jsonl or its report folder,"
            " instead of drawing new ones: the same conditions for another version or robot"
        )
        add("--conditions", metavar="FILE", default="", help=text)
        text = (
            "run the cases on Ray: 'ray' for processes of this machine (-j) or the cluster of"
            " RAY_ADDRESS, 'ray://HOST:PORT' for another cluster; needs the extra `cluster`"
        )
        add("--on", metavar="CLUSTER", dest="cluster", default="", help=text)

    def run(self, run_files: RunFiles, call: RunCall) -> int:
        """Run scenarios; every suite with samples gets a file of their conditions."""
        processors = set[str]()
        arguments, hooks = call.arguments, replace(call.hooks, write=_write)
        hooks = replace(hooks, begun=lambda suite: _page_updates(arguments, suite))
        if arguments.cluster:
            hooks = replace(hooks, execute=_on_cluster(arguments, processors))
        conditions = _conditions(arguments, call.files)
        if conditions is not None:
            hooks = replace(hooks, cases=conditions.replace)
        if arguments.shard:
            hooks = _with_part(hooks, arguments, conditions)
        code = run_files(replace(call, hooks=hooks))
        if len(processors) > 1 and arguments.format == "full":
            say(
                f"the cases ran on {len(processors)} processor families"
                f" ({'; '.join(sorted(processors))}): compare their verdicts, not their digests"
            )
        return code


def _page_updates(arguments: argparse.Namespace, suite: SuiteRun) -> Callable[[int], None]:
    """A function that updates the page of a running suite with each result."""
    if not has_page(arguments, suite):
        return lambda _index: None
    from harness.plugins.campaigns.live_page import LivePage

    return LivePage(suite, Path(arguments.report_dir)).result


def _on_cluster(arguments: argparse.Namespace, processors: set[str]) -> Execute:
    """What runs cases on the cluster of `--on`, and adds its nodes' processor families to a set."""
    from harness.plugins.campaigns.cluster.ray_cluster import RayCluster, check_cluster

    check_cluster(arguments.cluster)
    if arguments.in_process:
        raise UsageError("--on and --in-process exclude each other")

    def execute(
        jobs: Sequence[RunRequest], files: Sequence[Path], is_needless: Chooser
    ) -> Iterator[tuple[int, CaseResult]]:
        cluster = RayCluster(jobs, hard_cap=arguments.hard_cap, is_needless=is_needless)
        try:
            yield from cluster.run(arguments.cluster, arguments.workers, files)
        finally:
            processors.update(cluster.processors)

    return execute


def _conditions(arguments: argparse.Namespace, files: Sequence[Path]) -> Conditions | None:
    """The samples of `--conditions`."""
    if not arguments.conditions:
        return None
    from harness.plugins.campaigns.conditions import read_conditions

    given = {"--seed": arguments.seed, "--samples": arguments.samples}
    for option, value in given.items():
        if value is not None:
            raise UsageError(f"--conditions and {option} exclude each other")
    conditions = read_conditions(Path(arguments.conditions))
    conditions.check(files)
    return conditions


def _with_part(
    hooks: SuiteHooks, arguments: argparse.Namespace, conditions: Conditions | None
) -> SuiteHooks:
    """Hooks that choose the part of `--shard`, and describe it for a merge in its report folder."""
    from harness.plugins.campaigns.shards import record_of, shard_of, write_shard_record

    shard = shard_of(arguments.shard)
    root = Path(arguments.report_dir)

    def planned(files: Sequence[Path], request: SuiteRequest) -> None:
        if request.report_root is None:
            complain("note: with --no-report a part leaves nothing to merge; use --no-page instead")
            return
        digest = "" if conditions is None else conditions.digest
        write_shard_record(record_of(files, request, shard, root, digest))
        if conditions is not None:
            conditions.copy(root)  # a merge has neither the scenario files nor the conditions

    return replace(hooks, part=shard.part_of, planned=planned)


def _write(suite: SuiteRun, folder: Path, history: History) -> tuple[Path, Columns]:
    """Write the files of a suite, and the conditions of its samples."""
    from harness.plugins.campaigns.conditions import write_results

    return write_results(suite, folder, history)
