"""The web server: viser's with the guard before it, the studio's page and its WebSocket."""

from __future__ import annotations

import contextlib
import errno
import io
import logging
import socket
from collections.abc import Awaitable, Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

import viser
import websockets.asyncio.server
from viser._messages import ShareUrlDisconnect, ShareUrlRequest
from websockets.asyncio.server import ServerConnection
from websockets.frames import CloseCode
from websockets.http11 import Request, Response

from harness.core.errors import HarnessError
from harness.core.limits import STUDIO_MESSAGE, STUDIO_PAGES
from harness.plugins.studio.guard import PAGE_POLICY, SCENE_POLICY, SOCKET_PATH, Asset, Guard

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
    """A page of the studio at `/`, the scripts, the code editor's, and viser's client."""
    import django_static_ace_builds

    assets: dict[str, Asset] = {}
    for each in (files("harness.plugins.studio") / "page").iterdir():
        suffix = Path(each.name).suffix
        if suffix in KINDS:
            policy = PAGE_POLICY if suffix == ".html" else ""
            name = "/" if each.name == index else f"/studio/{each.name}"
            assets[name] = Asset.of(each.read_bytes(), KINDS[suffix], policy)
    theme = (files("harness.reporting.html") / "page" / "theme.css").read_bytes()
    assets["/studio/theme.css"] = Asset.of(theme, KINDS[".css"])
    editor = Path(next(iter(django_static_ace_builds.__path__))) / "static" / "ace-builds"
    for name in EDITOR_FILES:
        assets[f"/ace/{name}"] = Asset.of((editor / name).read_bytes(), KINDS[".js"])
    client = Path(viser.__file__).parent / "client" / "build" / "index.html"
    assets["/scene"] = Asset.of(client.read_bytes(), KINDS[".html"], SCENE_POLICY)
    return assets


def start_server(host: str, port: int, guard: Guard, handler: Handler) -> viser.ViserServer:
    """Start viser's server so that each request passes the guard first.

    viser accepts WebSockets of any origin and has no hook for that; the function that it starts its
    server with is replaced while it starts.

    Args:
        port: The port; 0 for any that is free.
        handler: Speaks with the studio's own page.

    Raises:
        PortInUseError: Another program listens on the port.
    """
    _refuse_used_port(host, port)
    logging.getLogger("websockets.server").setLevel(logging.CRITICAL)  # not each bad request
    serve = websockets.asyncio.server.serve

    def guarded(viser_handler: Handler, *arguments: Any, **options: Any) -> Any:
        def process(connection: ServerConnection, request: Request) -> Response | None:
            return guard.response(request, connection.local_address[1])

        open_sockets: set[ServerConnection] = set()

        async def handle(connection: ServerConnection) -> None:
            request = connection.request
            is_page = request is not None and request.path.partition("?")[0] == SOCKET_PATH
            if len(open_sockets) >= 2 * STUDIO_PAGES:  # a page has one of its own and one of viser
                await connection.close(CloseCode.TRY_AGAIN_LATER, "too many pages are open")
                return
            open_sockets.add(connection)
            try:
                await (handler if is_page else viser_handler)(connection)
            finally:
                open_sockets.discard(connection)

        bounds = {"process_request": process, "max_size": STUDIO_MESSAGE}
        return serve(handle, *arguments, **{**options, **bounds})

    websockets.asyncio.server.serve = guarded
    try:
        with contextlib.redirect_stdout(io.StringIO()):  # viser's banner has no token
            server = viser.ViserServer(host=host, port=port, verbose=False)
    finally:
        websockets.asyncio.server.serve = serve
    _refuse_sharing(server)
    return server


def _refuse_sharing(server: viser.ViserServer) -> None:
    """Take away a page's right to publish the studio through viser's tunnel."""
    for message in (ShareUrlRequest, ShareUrlDisconnect):
        server._websock_server.unregister_handler(message)  # noqa: SLF001 - viser has no option


def _refuse_used_port(host: str, port: int) -> None:
    """Viser would take the next port instead."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            advice = "; `--port 0` takes any free port" if error.errno == errno.EADDRINUSE else ""
            message = f"cannot listen on {host}:{port}: {error.strerror}{advice}"
            raise PortInUseError(message) from error
