"""Who may talk to the studio: Host, Origin and token of each request; the pages it serves."""

from __future__ import annotations

import gzip
import hmac
import http
import secrets
from collections.abc import Mapping
from dataclasses import dataclass, field
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs, urlsplit

from websockets.datastructures import Headers
from websockets.http11 import Request, Response

COOKIE = "harness_studio"
SOCKET_PATH = "/studio/ws"
LOOPBACK = ("127.0.0.1", "localhost", "[::1]")

PAGE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:;"
    " connect-src 'self'; base-uri 'none'; form-action 'none';"
    " frame-ancestors 'none'"
)
"""Scripts only from the studio itself; the code editor writes its styles into the page."""


@dataclass(frozen=True)
class Asset:
    """A file that the studio serves.

    Attributes:
        content: The bytes, compressed with gzip.
        policy: The Content-Security-Policy; empty for what is no page.
    """

    content: bytes
    kind: str
    policy: str = ""

    @classmethod
    def of(cls, content: bytes, kind: str, policy: str = "") -> Asset:
        """Compress a file's content."""
        return cls(gzip.compress(content, 5, mtime=0), kind, policy)


@dataclass(frozen=True)
class Guard:
    """Answers requests, and refuses those of other sites and of strangers.

    Attributes:
        assets: What is served, by path; nothing else is, so no path leads to the disk.
        is_open: Whether other machines may connect; each request then needs the token.
        token: The secret in the address; empty on loopback.
    """

    assets: Mapping[str, Asset]
    is_open: bool = False
    token: str = field(default="", repr=False)

    @classmethod
    def of(cls, assets: Mapping[str, Asset], *, is_open: bool) -> Guard:
        """A guard with a token of its own, where one is needed."""
        return cls(assets, is_open, secrets.token_urlsafe(24) if is_open else "")

    def refusal(self, request: Request, port: int) -> str:
        """Why a request is refused; empty where it may be answered."""
        hosts, origins = (request.headers.get_all(name) for name in ("Host", "Origin"))
        if len(hosts) != 1 or len(origins) > 1:
            return "a request has one Host, and at most one Origin"
        [host] = hosts
        if not self.is_open and host not in {f"{name}:{port}" for name in LOOPBACK}:
            return "this Host is not the studio's"
        if any(origin != f"http://{host}" for origin in origins):
            return "a page of another origin may not use the studio"
        if self.token and not self._has_token(request):
            return "the address has no token, or a wrong one: open the one that the terminal shows"
        return ""

    def response(self, request: Request, port: int) -> Response | None:
        """The answer to a request; None lets a WebSocket be opened."""
        refusal = self.refusal(request, port)
        if refusal:
            return _plain(http.HTTPStatus.FORBIDDEN, refusal)
        path = urlsplit(request.path).path
        is_socket = request.headers.get("Upgrade", "").lower() == "websocket"
        if is_socket and path == SOCKET_PATH:
            return None
        asset = self.assets.get(path)
        if asset is None:
            return _plain(http.HTTPStatus.NOT_FOUND, "there is no such page")
        headers = Headers(
            {
                "Content-Type": asset.kind,
                "Content-Encoding": "gzip",
                "Content-Length": str(len(asset.content)),
                "X-Content-Type-Options": "nosniff",
                "Referrer-Policy": "no-referrer",
                "Cross-Origin-Resource-Policy": "same-origin",
                "Cache-Control": "no-store",
            }
        )
        if asset.policy:
            headers["Content-Security-Policy"] = asset.policy
        if self.token:
            headers["Set-Cookie"] = f"{COOKIE}={self.token}; HttpOnly; SameSite=Strict; Path=/"
        return Response(http.HTTPStatus.OK, "OK", headers, asset.content)

    def _has_token(self, request: Request) -> bool:
        given = parse_qs(urlsplit(request.path).query).get("token", [])
        try:
            cookie = SimpleCookie(request.headers.get("Cookie", "")).get(COOKIE)
        except CookieError:
            cookie = None
        if cookie is not None:
            given = [*given, cookie.value]
        return any(hmac.compare_digest(each.encode(), self.token.encode()) for each in given)


def _plain(status: http.HTTPStatus, text: str) -> Response:
    body = f"{text}\n".encode()
    headers = Headers(
        {"Content-Type": "text/plain; charset=utf-8", "Content-Length": str(len(body))}
    )
    return Response(status, status.phrase, headers, body)
