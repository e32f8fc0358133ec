"""`harness run --live`: a page that shows the cases of a suite while they run."""

from __future__ import annotations

import contextlib
import threading
import time
from dataclasses import dataclass
from multiprocessing.connection import Connection, Listener
from pathlib import Path

from harness.core.printable import printable
from harness.core.socket_folder import socket_folder
from harness.plugins.studio.guard import LOOPBACK, Guard
from harness.plugins.studio.live_stream import LiveCase, LiveFrame
from harness.plugins.studio.scene_view import SceneView
from harness.plugins.studio.server import StudioServer, page_assets
from harness.plugins.studio.session import FRAME, Message, RefusedError, Session
from harness.plugins.studio.verdict_messages import NO_VERDICTS, verdicts_message
from harness.reporting.progress_events import (
    Judged,
    ProgressEvent,
    StepFinished,
    StepStarted,
    Working,
)
from harness.reporting.result import CaseResult

MOST_CASES = 40  # that can be chosen on the page: those that run, and the last that have ended
LATEST = 0  # the number that stands for whichever case began last


@dataclass(eq=False)
class WatchedCase:
    """A case, with the newest that it sent; its own thread writes it.

    Attributes:
        number: Its number in the order in which the cases began, from 1.
        doing: The step that is executed, or the work after the steps.
        steps_done: The number of steps that have ended.
    """

    number: int
    case: LiveCase
    frame: LiveFrame | None = None
    doing: str = ""
    steps_done: int = 0
    result: CaseResult | None = None
    is_running: bool = True

    def hear(self, event: ProgressEvent) -> None:
        """Take note of an event."""
        match event:
            case StepFinished() if event.index >= 0:
                self.steps_done = event.index + 1
            case StepStarted():
                self.doing = event.step
            case Working():
                self.doing = event.what
            case Judged():
                self.result = event.result
            case _:
                pass

    @property
    def status(self) -> str:
        """The outcome; empty while the case runs."""
        if self.result is not None:
            return self.result.outcome
        return "" if self.is_running else "ended without a result"


class Watch:
    """The page of a suite that runs, and the socket at which its cases report."""

    def __init__(self) -> None:
        self._folder = socket_folder("harness-live-")  # for this user alone
        self.address = str(Path(self._folder.name) / "cases")
        self._listener = Listener(self.address, "AF_UNIX", backlog=64)
        self._cases: list[WatchedCase] = []
        self._count = self._chosen = LATEST
        self._has_ended = False
        self._shown: WatchedCase | None = None
        self._drawn: LiveFrame | None = None
        self._announced: CaseResult | None = None
        self._last_scene = 0.0
        self._server: StudioServer | None = None
        self._session = Session(
            self._do, self._frame, self._greeting, {"choose": self._choose}, lambda: None
        )
        self._view = SceneView(self._session.broadcast)

    def __enter__(self) -> Watch:
        guard = Guard.of(page_assets("watch.html"), is_open=False)
        self._server = StudioServer(LOOPBACK[0], 0, guard, self._session.handle)
        threading.Thread(target=self._accept, name="live-cases", daemon=True).start()
        self._session.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._has_ended = True
        self._session.post(lambda: self._session.broadcast(self._state()))
        self._session.stop()
        self._listener.close()
        if self._server is not None:
            self._server.stop()
        self._folder.cleanup()

    @property
    def page(self) -> str:
        """The address of the page."""
        assert self._server is not None
        return f"http://{LOOPBACK[0]}:{self._server.port}/"

    def wait_for_page(self, seconds: float) -> None:
        """Wait until the page is open, but not for ever."""
        end = time.monotonic() + seconds
        while not self._session.viewers and time.monotonic() < end:
            time.sleep(0.05)

    # -- what cases send ----------------------------------------------------------------------

    def _accept(self) -> None:
        while not self._has_ended:
            try:
                connection = self._listener.accept()
            except OSError:  # it was closed
                return
            threading.Thread(target=self._listen, args=(connection,), daemon=True).start()

    def _listen(self, connection: Connection) -> None:
        """Take in what one case sends, until it ends."""
        watched: WatchedCase | None = None
        with contextlib.suppress(EOFError, OSError), connection:
            while True:
                match connection.recv():
                    case LiveCase() as case:
                        self._count += 1
                        watched = WatchedCase(self._count, case)
                        self._cases.append(watched)
                    case LiveFrame() as frame if watched is not None:
                        watched.frame = frame
                    case ProgressEvent() as event if watched is not None:
                        watched.hear(event)
                    case _:
                        pass
        if watched is not None:
            watched.is_running = False
            ended = [each for each in self._cases if not each.is_running]
            for old in ended[: max(0, len(self._cases) - MOST_CASES)]:
                self._cases.remove(old)

    # -- what pages see -----------------------------------------------------------------------

    def _frame(self, is_due: bool) -> None:
        if not self._session.viewers:
            return
        now = time.monotonic()
        cases = list(self._cases)
        shown = next((each for each in cases if each.number == self._chosen), None)
        if shown is None and cases:
            shown = max(cases, key=lambda each: (each.is_running, each.number))
        if shown is not None and now - self._last_scene >= 0.9 * FRAME:
            self._last_scene = now
            self._show(shown)
        if is_due:
            self._session.broadcast(self._state())
            if shown is not None and shown.result is not self._announced:
                self._announced = shown.result
                self._session.broadcast(_verdicts(shown.result))

    def _show(self, shown: WatchedCase) -> None:
        view = self._view
        if shown is not self._shown:
            view.show_robot(shown.case.robot())
            view.show_objects(shown.case.objects)
            self._shown, self._drawn = shown, None
        if shown.frame is not None and shown.frame is not self._drawn:
            self._drawn = shown.frame
            view.move(shown.frame.joint_positions, shown.frame.objects, {})

    def _state(self) -> Message:
        shown, cases = self._shown, list(self._cases)
        frame = None if shown is None else shown.frame
        return {
            "type": "watch",
            "cases": [
                {"number": each.number, "name": printable(each.case.name), "status": each.status}
                for each in cases
            ],
            "chosen": self._chosen,
            "shown": 0 if shown is None else shown.number,
            "time": 0.0 if frame is None else round(frame.time, 3),
            "doing": "" if shown is None else printable(shown.doing),
            "steps_done": 0 if shown is None else shown.steps_done,
            "step_count": 0 if shown is None else shown.case.steps,
            "has_ended": self._has_ended,
        }

    def _greeting(self) -> list[Message]:
        return [*self._view.greeting(), self._state(), _verdicts(self._announced)]

    def _choose(self, message: Message) -> Message:
        self._chosen = int(message["number"])
        return {}

    def _do(self, name: str, _: Message) -> Message:
        raise RefusedError(f"a page that watches has no action '{printable(name)}'")


def _verdicts(result: CaseResult | None) -> Message:
    """The steps and verdicts of a case that was judged; nothing while it runs."""
    if result is None:
        return NO_VERDICTS
    decided = ((verdict, True) for verdict in result.verdicts)
    return verdicts_message(result.outcome, result.digest, result.steps, decided)
