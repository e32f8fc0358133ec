"""Verdicts on a live cell: what a run measures and judges, on the samples so far."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass, replace

from harness.assertions.judge import judge
from harness.assertions.placed import PlacedExpectation
from harness.core.activity import unobserved
from harness.recording.digest import digest
from harness.recording.run import Run
from harness.recording.verdict import Verdict
from harness.session.observe import observed_run, with_believed_poses
from harness.session.pictures import Pictures
from harness.session.record import executed_run
from harness.session.run_request import RunRequest
from harness.studio.document import Document
from harness.studio.live_cell import LiveCell

FINAL_FAILURES = ("always", "never")
"""Words whose failure is final, whatever later samples show."""


@dataclass(frozen=True, eq=False)
class Judged:
    """The verdicts on the steps executed so far.

    Attributes:
        is_decided: Whether each verdict is final although steps remain.
        outcome: `passed` or `failed`; empty while steps remain.
        digest: The digest of the run; empty while steps remain, or after motions by hand.
    """

    run: Run
    verdicts: tuple[Verdict, ...]
    is_decided: tuple[bool, ...]
    outcome: str
    digest: str


def judged(cell: LiveCell, document: Document | None = None) -> Judged:
    """Verdicts on the samples so far; the digest once a run would be at its end.

    They are what a run measures and judges: the same functions, on the same samples.

    Args:
        cell: The live cell that is judged.
        document: A text with other expectations, which are judged in place of the cell's.
    """
    prepared = cell.prepared
    if document is not None:
        prepared = replace(prepared, expectations=cell.prepared_as(document).expectations)
    request = RunRequest(cell.files.path, text=cell.document.text)
    execution = cell.execution.finish()
    signals = with_believed_poses(prepared, execution, cell.simulator.finish())
    run = executed_run(request, prepared, execution, signals, cell.simulator.overlaps_at_start)
    with closing(Pictures(request, prepared, run)) as pictures:
        run = pictures.captured(observed_run(prepared, run), unobserved)
    verdicts = judge(run, prepared.expectations)
    is_over = cell.steps_done >= cell.document.step_count or bool(execution.ended_early)
    is_good = not run.ended_early and all(each.status == "passed" for each in verdicts)
    return Judged(
        run,
        verdicts,
        tuple(
            is_over or _is_decided(placed, verdict, run)
            for placed, verdict in zip(prepared.expectations, verdicts, strict=True)
        ),
        ("passed" if is_good else "failed") if is_over else "",
        digest(run, verdicts) if is_over and cell.has_run_digest else "",
    )


def _is_decided(placed: PlacedExpectation, verdict: Verdict, run: Run) -> bool:
    """Whether the window has ended, or the failure is final."""
    specs = (placed.spec, *placed.spec.predicates().values())
    name = next((spec.during for spec in specs if spec.during), placed.step)
    if name:
        return any(name in (s.id, s.path) and s.status != "not reached" for s in run.steps)
    return verdict.status == "failed" and placed.spec.word in FINAL_FAILURES
