"""Verdicts on a live cell, as a run judges them, on the samples so far; in the background."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass, replace

from harness.core.activity import unobserved
from harness.core.errors import HarnessError
from harness.judging.judge import judge
from harness.judging.placed import PlacedExpectation
from harness.plugins.studio.document import Document
from harness.plugins.studio.live_cell import LiveCell
from harness.plugins.studio.newest import Newest
from harness.plugins.studio.session import Message
from harness.plugins.studio.verdict_messages import NO_VERDICTS, verdicts_message
from harness.recording.digest import digest
from harness.recording.run import Run
from harness.recording.verdict import Verdict
from harness.session.pictures import Pictures
from harness.session.run_builder import RunBuilder
from harness.session.run_request import RunRequest

FINAL_FAILURES = ("always", "never")  # words whose failure is final, whatever later samples show


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
        document: A text with other expectations, which are judged in place of the cell's.
    """
    prepared = cell.prepared
    if document is not None:
        prepared = replace(prepared, expectations=cell.prepared_as(document).expectations)
    request = RunRequest(cell.files.path, text=cell.document.text)
    execution = cell.execution.finish()
    builder = RunBuilder(request, prepared, execution, cell.simulator)
    with closing(Pictures(request, prepared)) as pictures:
        pictures.executed(builder.record)
        builder.observe()
        run = builder.build(pictures.captured(unobserved))
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


class LiveVerdicts:
    """The newest verdicts on the text of a cell, since it was at its start.

    Whoever changes the text or the state otherwise than by executing the next step calls `forget`,
    which gives up what is being judged too: no verdict and no digest is of another text.

    Attributes:
        message: The verdicts as pages are sent them.
        text: The text that they are of; empty while there are none.
    """

    def __init__(self) -> None:
        self.message = NO_VERDICTS
        self.text = ""
        self._work: Newest[Message] = Newest()

    def begin(self, cell: LiveCell, *, is_last: bool) -> None:
        """Judge the cell as it is now, unless an earlier state is still being judged.

        Args:
            is_last: Whether no later state follows soon; earlier ones are then given up.
        """
        if is_last or not self._work.is_busy:
            self.text = cell.document.text
            self._work.begin(lambda: _message(judged(cell)))

    def taken(self, *, wait: bool = False) -> Message | None:
        """The message for every page, once; None while there is nothing new."""
        try:
            message = self._work.taken(wait=wait)
        except HarnessError as error:
            return {"type": "note", "kind": "failed", "text": f"no verdicts: {error}"}
        if message is not None:
            self.message = message
        return message

    def forget(self) -> None:
        """Give up what was judged, and what is being judged."""
        self._work.cancel()
        self.message, self.text = NO_VERDICTS, ""


def _message(judged: Judged) -> Message:
    top_level = [each for each in judged.run.steps if "." not in each.path]
    verdicts = zip(judged.verdicts, judged.is_decided, strict=True)
    return verdicts_message(judged.outcome, judged.digest, top_level, verdicts)
