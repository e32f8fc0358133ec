"""The web server: pages, and the WebSocket of each, with the guard before both."""

from __future__ import annotations

import asyncio
import errno
import logging
import socket
import threading
from collections.abc import Awaitable, Callable
from contextlib import suppress
from importlib.resources import files
from pathlib import Path

from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.frames import CloseCode
from websockets.http11 import Request, Response

from harness.core.errors import HarnessError
from harness.core.limits import STUDIO_MESSAGE, STUDIO_PAGES
from harness.plugins.studio.guard import PAGE_POLICY, Asset, Guard

EDITOR_FILES = (
    "ace.js",
    "mode-yaml.js",
    "theme-textmate.js",
    "theme-tomorrow_night.js",
    "ext-language_tools.js",
    "ext-searchbox.js",
)
KINDS = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
}

Handler = Callable[[ServerConnection], Awaitable[None]]


class PortInUseError(HarnessError):
    """Another program listens on the port."""


def page_assets(index: str = "index.html") -> dict[str, Asset]:
    """A page of the studio at `/`, its scripts, those of the report's view, and the editor's."""
    import django_static_ace_builds

    report = files("harness.reporting.html") / "page"
    assets: dict[str, Asset] = {}
    for each in (files("harness.plugins.studio") / "page").iterdir():
        suffix = Path(each.name).suffix
        if suffix in KINDS:
            policy = PAGE_POLICY if suffix == ".html" else ""
            name = "/" if each.name == index else f"/studio/{each.name}"
            assets[name] = Asset.of(each.read_bytes(), KINDS[suffix], policy)
    for each in report.iterdir():
        if each.name.endswith(".js"):
            assets[f"/view/{each.name}"] = Asset.of(each.read_bytes(), KINDS[".js"])
    theme = (report / "theme.css").read_bytes()
    assets["/studio/theme.css"] = Asset.of(theme, KINDS[".css"])
    editor = Path(next(iter(django_static_ace_builds.__path__))) / "static" / "ace-builds"
    for name in EDITOR_FILES:
        assets[f"/ace/{name}"] = Asset.of((editor / name).read_bytes(), KINDS[".js"])
    return assets


class StudioServer:
    """A server in a thread of its own, until it is stopped.

    Attributes:
        port: The port at which it listens.
    """

    def __init__(self, host: str, port: int, guard: Guard, handler: Handler) -> None:
        """Begin to listen.

        Args:
            host: The address at which it listens.
            port: The port; 0 for any that is free.
            guard: Answers requests, and refuses those of strangers.
            handler: Speaks with one page until it leaves.

        Raises:
            PortInUseError: Another program listens on the port.
        """
        logging.getLogger("websockets.server").setLevel(logging.CRITICAL)  # not each bad request
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="web", daemon=True)
        self._guard, self._handler = guard, handler
        self._open: set[ServerConnection] = set()
        self._listener = _listener(host, port)
        self.port = int(self._listener.getsockname()[1])
        self._thread.start()
        started = asyncio.run_coroutine_threadsafe(self._serve(), self._loop)
        self._server = started.result()

    def stop(self) -> None:
        """Close every connection, and end the thread."""

        async def end() -> None:
            self._server.close()
            await self._server.wait_closed()

        with suppress(TimeoutError):  # a page that does not leave ends with the process
            asyncio.run_coroutine_threadsafe(end(), self._loop).result(timeout=10.0)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(timeout=5.0)
        if not self._thread.is_alive():
            self._loop.close()

    async def _serve(self) -> Server:
        return await serve(
            self._handle,
            sock=self._listener,
            process_request=self._answer,
            max_size=STUDIO_MESSAGE,
            compression=None,  # it would take longer than loopback takes
        )

    def _answer(self, _: ServerConnection, request: Request) -> Response | None:
        return self._guard.response(request, self.port)

    async def _handle(self, connection: ServerConnection) -> None:
        if len(self._open) >= STUDIO_PAGES:
            await connection.close(CloseCode.TRY_AGAIN_LATER, "too many pages are open")
            return
        self._open.add(connection)
        try:
            await self._handler(connection)
        finally:
            self._open.discard(connection)


def _listener(host: str, port: int) -> socket.socket:
    """A socket that listens at an address.

    Raises:
        PortInUseError: That is not possible.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        return socket.create_server((host, port), family=family)
    except OSError as error:
        advice = "; `--port 0` takes any free port" if error.errno == errno.EADDRINUSE else ""
        reason = error.strerror or str(error)
        message = f"cannot listen on {host}:{port}: {reason}{advice}"
        raise PortInUseError(message) from error
