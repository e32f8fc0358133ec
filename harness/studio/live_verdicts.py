"""Verdicts while the steps are executed: judged in the background, the newest state first."""

from __future__ import annotations

from harness.core.errors import HarnessError
from harness.studio.judging import Judged, judged
from harness.studio.live_cell import LiveCell
from harness.studio.newest import Newest
from harness.studio.session import Message
from harness.studio.verdict_messages import NO_VERDICTS, verdicts_message


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
            cell: The live cell that is judged.
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
