"""The session of all pages: one cell, one controller, any number of spectators."""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import json
import queue
import threading
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed

from harness.core.errors import HarnessError, SpecError
from harness.core.limits import STUDIO_REQUESTS
from harness.core.printable import printable
from harness.core.untrusted_json import parse_json

FRAME = 1 / 30  # time between two pictures of the scene [s]
PANEL_PERIOD = 0.1  # time between two updates of the numbers on the page [s]
MOST_MESSAGES = 500  # messages of the state that wait for a slow page; of all twice as many

Message = dict[str, Any]


class RefusedError(HarnessError):
    """An action that the studio refuses; the message says why."""


@dataclass(eq=False)
class Viewer:
    """An open page.

    Attributes:
        name: The name by which the page comes back after a lost connection.
    """

    name: str
    outbox: asyncio.Queue[str]
    loop: asyncio.AbstractEventLoop

    def send(self, message: Message) -> None:
        """Send a message, from any thread."""
        text = json.dumps(message, default=float)

        def put() -> None:
            most = MOST_MESSAGES if message["type"] == "state" else 2 * MOST_MESSAGES
            if self.outbox.qsize() < most:
                self.outbox.put_nowait(text)

        self.loop.call_soon_threadsafe(put)


@dataclass(eq=False)
class Session:
    """Viewers, who of them controls, and the thread that owns the cell.

    Attributes:
        on_request: Carries out a request of a page, in the cell's thread; returns the reply.
        on_frame: Called in the cell's thread for every picture; its argument says whether the
            numbers are due too.
        greeting: What a page that connects is sent, in the cell's thread.
        at_once: Requests that are answered while a step is being executed.
        on_defect: Called after a defect of the program in the cell's thread.
    """

    on_request: Callable[[str, Message], Message]
    on_frame: Callable[[bool], None]
    greeting: Callable[[], list[Message]]
    at_once: dict[str, Callable[[Message], Message]]
    on_defect: Callable[[], None]
    viewers: list[Viewer] = field(default_factory=list[Viewer])
    controller: str = ""
    _next: str = ""
    _jobs: queue.SimpleQueue[Callable[[], object] | None] = field(
        default_factory=queue.SimpleQueue[Callable[[], object] | None]
    )
    _last_panel: float = 0.0
    _thread: threading.Thread | None = None

    def start(self) -> None:
        """Start the thread that owns the cell."""
        self._thread = threading.Thread(target=self._run, name="studio-cell", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """End the thread after the job it is at."""
        self._jobs.put(None)
        if self._thread is not None:
            self._thread.join(timeout=5.0)
        for viewer in tuple(self.viewers):  # the last messages leave
            with contextlib.suppress(TimeoutError, RuntimeError):
                sent = asyncio.run_coroutine_threadsafe(viewer.outbox.join(), viewer.loop)
                sent.result(timeout=1.0)

    def post(self, job: Callable[[], object]) -> None:
        """Let the cell's thread do something."""
        self._jobs.put(job)

    def broadcast(self, message: Message, *, but: str = "") -> None:
        """Send a message to every page, but one."""
        for viewer in tuple(self.viewers):
            if not but or viewer.name != but:
                viewer.send(message)

    def frame(self) -> None:
        """Show the cell as it is now; called often, also while a step is executed."""
        now = time.monotonic()
        is_due = now - self._last_panel >= PANEL_PERIOD
        if is_due:
            self._last_panel = now
        self.on_frame(is_due)

    def announce_control(self) -> None:
        """Show every page who controls."""
        for viewer in tuple(self.viewers):
            viewer.send(
                {
                    "type": "control",
                    "is_mine": viewer.name == self.controller,
                    "is_free": not self.controller,
                    "pages": len(self.viewers),
                }
            )

    async def handle(self, connection: ServerConnection) -> None:
        """Speak with one page until it leaves."""
        viewer: Viewer | None = None
        sender: asyncio.Task[None] | None = None
        try:
            async for text in connection:
                message = _parsed(text)
                if message is None:
                    continue
                if viewer is None:
                    viewer = Viewer(
                        str(message.get("page", ""))[:64],
                        asyncio.Queue(),
                        asyncio.get_running_loop(),
                    )
                    sender = asyncio.create_task(_send_all(connection, viewer.outbox))
                    self._enter(viewer)
                    continue
                self._receive(viewer, message)
        except ConnectionClosed:
            pass
        finally:
            if viewer is not None:
                self._leave(viewer)
            if sender is not None:
                sender.cancel()

    @property
    def _present(self) -> set[str]:
        return {each.name for each in self.viewers}

    def _leave(self, viewer: Viewer) -> None:
        """Take a page out; whoever requested control of one that left has it."""
        self.viewers.remove(viewer)
        if self.controller not in self._present and self._next in self._present:
            self.controller, self._next = self._next, ""
        self.announce_control()

    def _enter(self, viewer: Viewer) -> None:
        self.viewers.append(viewer)
        if self.controller not in self._present:
            self.controller = viewer.name
        self.announce_control()

        def greet() -> None:
            for message in self.greeting():
                viewer.send(message)

        self.post(greet)

    def _receive(self, viewer: Viewer, message: Message) -> None:
        name, number = str(message.get("do", "")), message.get("number")

        def reply(answer: Message) -> None:
            viewer.send({"type": "reply", "number": number, **answer})

        if name == "control":
            self._control(viewer, str(message.get("word", "")))
            return reply({})
        if viewer.name != self.controller and name not in ("complete", "hover"):
            return reply({"error": "another page controls the cell; request control first"})
        if name in self.at_once:
            return reply(guarded(lambda: self.at_once[name](message)))

        if self._jobs.qsize() >= STUDIO_REQUESTS:
            return reply({"error": "too many requests wait; send this one again later"})

        def job() -> None:
            try:
                answer = guarded(lambda: self.on_request(name, message))
            except Exception:  # the page waits for a reply
                reply({"error": f"'{printable(name)}' met a defect of the program"})
                raise
            reply(answer)

        return self.post(job)

    def _control(self, viewer: Viewer, word: str) -> None:
        """Request control, pass it on, or take it where no page has it."""
        present = self._present
        if word == "request":
            if self.controller not in present:
                self.controller = viewer.name
            else:
                self._next = viewer.name
                self.broadcast({"type": "request", "page": alias(viewer.name)})
        elif word == "release" and viewer.name == self.controller:
            self.controller = next((n for n in present if n != viewer.name), viewer.name)
        elif viewer.name == self.controller:
            self.controller = next((name for name in present if alias(name) == word), viewer.name)
        self.announce_control()

    def _run(self) -> None:
        while True:
            try:
                job = self._jobs.get(timeout=0.5 * FRAME)
            except queue.Empty:
                job = self.frame
            if job is None:
                return
            try:
                job()
            except Exception:  # noqa: BLE001 - the thread continues, and with it every session
                trace = traceback.format_exc()
                self.broadcast({"type": "note", "kind": "failed", "text": printable(trace)})
                self.on_defect()


def alias(name: str) -> str:
    """A name for a page that other pages may know; its own name is what it controls with."""
    return hashlib.sha256(name.encode()).hexdigest()[:12]


def guarded(action: Callable[[], Message]) -> Message:
    """What an action replies, or its mistake as a reply."""
    try:
        return action()
    except SpecError as error:
        return {"error": "; ".join(each.sentence for each in error.problems)}
    except (
        HarnessError,
        ValueError,
        LookupError,
        TypeError,
        ArithmeticError,
        AttributeError,
    ) as error:
        text = str(error) if isinstance(error, HarnessError) else f"a bad request: {error!r}"
        return {"error": text}


def _parsed(text: str | bytes) -> Message | None:
    try:
        message: object = parse_json(text)
    except ValueError:
        return None
    return message if isinstance(message, dict) else None


async def _send_all(connection: ServerConnection, outbox: asyncio.Queue[str]) -> None:
    try:
        while True:
            await connection.send(await outbox.get())
            outbox.task_done()
    except ConnectionClosed:
        return
