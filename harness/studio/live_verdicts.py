"""Verdicts while the steps are executed: judged in the background, the newest state first."""

from __future__ import annotations

from harness.core.errors import HarnessError
from harness.studio.judging import judged
from harness.studio.live_cell import LiveCell
from harness.studio.messages import Message, verdicts_message
from harness.studio.newest import Newest


class LiveVerdicts:
    """The newest verdicts of a cell.

    Attributes:
        message: The verdicts as pages are sent them; None while there are none.
    """

    def __init__(self) -> None:
        self.message: Message | None = None
        self._work: Newest[Message] = Newest()
        self._text = self._judged_text = ""

    @property
    def is_busy(self) -> bool:
        """Whether verdicts are being computed."""
        return self._work.is_busy

    def begin(self, cell: LiveCell, *, is_last: bool) -> None:
        """Judge the cell as it is now, unless an earlier state is still being judged.

        Args:
            cell: The live cell that is judged.
            is_last: Whether no later state follows soon; earlier ones are then given up.
        """
        if is_last or not self._work.is_busy:
            self._text = cell.document.text
            self._work.begin(lambda: verdicts_message(judged(cell)))

    def taken(self, *, wait: bool = False) -> Message | None:
        """The message for every page, once; None while there is nothing new."""
        try:
            message = self._work.taken(wait=wait)
        except HarnessError as error:
            return {"type": "note", "kind": "failed", "text": f"no verdicts: {error}"}
        if message is not None:
            self.message, self._judged_text = message, self._text
        return message

    def digest_of(self, text: str) -> str:
        """The digest of the last whole run, if it was one of this text; else empty."""
        is_same = self.message is not None and self._judged_text == text
        return str(self.message["digest"]) if is_same and self.message else ""

    def forget(self) -> None:
        """The cell went back: what was judged is not its state."""
        self._work.cancel()
        self.message = None
