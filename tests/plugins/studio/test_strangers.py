"""What strangers send to a studio: raw requests, floods, and pages of other sites."""

import http.server
import json
import os
import socket
import threading
from contextlib import ExitStack, suppress

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from harness.core.limits import STUDIO_MESSAGE, STUDIO_PAGES, STUDIO_REQUESTS
from harness.plugins.ros.rtps.sockets import _interface_addresses
from tests.reporting.browser import new_context
from tests.waiting import HANG, wait_for

pytest.importorskip("django_static_ace_builds")

UPGRADE = "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
UPGRADE += "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"


@pytest.fixture(scope="module")
def served(serve):
    return serve()


def sent_raw(served, request):
    """The first line of the answer to some bytes; empty where the connection is closed."""
    with socket.create_connection(("127.0.0.1", served.port), timeout=HANG) as stream:
        with suppress(OSError):  # it may be closed before all is read
            stream.sendall(request)
            if not request.endswith(b"\r\n\r\n"):
                stream.shutdown(socket.SHUT_WR)
        answer = b""
        with suppress(OSError):
            while b"\r\n" not in answer and (part := stream.recv(4096)):
                answer += part
    return answer.split(b"\r\n")[0].decode("ascii", errors="replace")


def is_alive(served):
    """Whether the studio still serves its page to its own user."""
    head = f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{served.port}\r\nConnection: close\r\n\r\n"
    return sent_raw(served, head.encode()).endswith("200 OK")


RAW = {
    "no host": "GET / HTTP/1.1\r\n\r\n",
    "two hosts": "GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nHost: evil.example\r\n\r\n",
    "a host with a path": "GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}/evil\r\n\r\n",
    "a host that begins alike": "GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}.evil.example\r\n\r\n",
    "another address of the loopback": "GET / HTTP/1.1\r\nHost: 127.0.0.2:{port}\r\n\r\n",
    "a null origin": "GET /studio/ws HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: null\r\n"
    + UPGRADE + "\r\n",
    "an origin of another port": "GET /studio/ws HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n"
    "Origin: http://127.0.0.1:1\r\n" + UPGRADE + "\r\n",
    "an origin with https": "GET /studio/ws HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n"
    "Origin: https://127.0.0.1:{port}\r\n" + UPGRADE + "\r\n",
    "two origins": "GET /studio/ws HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n"
    "Origin: http://127.0.0.1:{port}\r\nOrigin: http://evil.example\r\n" + UPGRADE + "\r\n",
    "a form of another site": "POST / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n"
    "Origin: http://evil.example\r\nContent-Length: 10\r\n\r\ndo=save&x=",
    "an absolute address": "GET http://evil.example/ HTTP/1.1\r\nHost: evil.example\r\n\r\n",
    "a long header": "GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nX: " + "a" * 200_000 + "\r\n\r\n",
    "many headers": "GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n" + "X: a\r\n" * 10_000 + "\r\n",
    "no HTTP": "\x16\x03\x01\x02\x00\x01\x00",
}  # fmt: skip


@pytest.mark.parametrize("name", RAW)
def test_a_raw_request_of_a_stranger_is_refused(served, name):
    request = RAW[name].replace("{port}", str(served.port)).encode("latin-1")
    answer = sent_raw(served, request)
    assert "200" not in answer
    assert "101" not in answer
    assert is_alive(served)


def test_the_studio_listens_on_the_loopback_alone(served):
    others = [each for each in _interface_addresses() if not each.startswith("127.")]
    if not others:
        pytest.skip("this machine has no other address")
    for address in others:
        with pytest.raises(OSError), socket.create_connection((address, served.port), timeout=HANG):  # noqa: PT011
            pass


def test_a_message_beyond_the_limit_closes_its_connection_alone(served):
    address = f"ws://127.0.0.1:{served.port}/studio/ws"
    with connect(address) as large, connect(address) as small:
        small.send(json.dumps({"page": "small"}))
        small.recv()
        large.send(json.dumps({"page": "x" * STUDIO_MESSAGE}))
        with suppress(ConnectionClosed):
            while large.recv():
                pass
        assert large.close_code == 1009
        small.send(json.dumps({"do": "hover", "text": "", "line": 1, "column": 1, "number": 7}))
        heard = ""
        while '"number": 7' not in heard:
            heard = str(small.recv())


def test_more_pages_than_the_limit_are_sent_away(served):
    address = f"ws://127.0.0.1:{served.port}/studio/ws"
    with ExitStack() as stack:
        for _ in range(STUDIO_PAGES):
            stack.enter_context(connect(address))
        with pytest.raises(ConnectionClosed) as closed, connect(address) as late:
            late.recv()
        assert closed.value.rcvd.code == 1013

    def opens():
        with connect(address) as again, suppress(ConnectionClosed):
            again.send(json.dumps({"page": "again"}))
            return bool(again.recv())
        return False

    assert wait_for(opens)


def test_requests_that_wait_are_bounded(serve):
    """The cell is busy; a page that floods it gets errors, and no memory."""
    served = serve()
    session = served.studio.session
    is_free, is_busy = threading.Event(), threading.Event()
    address = f"ws://127.0.0.1:{served.port}/studio/ws"
    with connect(address) as page:
        page.send(json.dumps({"page": "flood"}))
        page.recv()
        session.post(lambda: (is_busy.set(), is_free.wait(HANG)))
        assert is_busy.wait(HANG)
        for number in range(3 * STUDIO_REQUESTS):
            page.send(json.dumps({"do": "nothing", "number": number}))
        heard = ""
        while "too many requests wait" not in heard:
            heard = str(page.recv())
        assert session._jobs.qsize() <= STUDIO_REQUESTS + 2  # noqa: SLF001 - what is bounded
        is_free.set()
    assert served.reply_to("reset") == {}


def test_random_bytes_and_messages_end_nothing(served):
    address = f"ws://127.0.0.1:{served.port}/studio/ws"
    for content in (b"\0" * 100, b"[" * 50_000, b'{"page": 1}' * 2, "null", "[]", '{"do": {}}'):
        with connect(address) as page, suppress(ConnectionClosed):
            page.send(content)
    for size in range(0, 200, 20):
        sent_raw(served, os.urandom(size))
    assert is_alive(served)


EVIL = """<!DOCTYPE html><title>evil</title><script>
const port = PORT, seen = {};
async function attempt(name, act) {
  try { seen[name] = await act(); } catch (e) { seen[name] = "refused"; }
}
const socket = (path) => new Promise((done, fail) => {
  const opened = new WebSocket(`ws://127.0.0.1:${port}${path}`);
  opened.onopen = () => { opened.send('{"page": "evil"}');
    opened.send('{"do": "save", "name": "evil.scenario.yaml", "number": 1}'); done("opened"); };
  opened.onerror = () => fail();
});
(async () => {
  await attempt("page", async () => (await fetch(`http://127.0.0.1:${port}/`)).status);
  await attempt("form", async () => {
    await fetch(`http://127.0.0.1:${port}/`, {method: "POST", mode: "no-cors", body: "do=save"});
    return "sent"; });
  await attempt("socket", () => socket("/studio/ws"));
  const frame = document.createElement("iframe");
  frame.src = `http://127.0.0.1:${port}/`;
  frame.onload = () => { document.title = "done"; window.seen = seen; };
  document.body.append(frame);
})();
</script><body></body>"""


def test_a_page_of_another_site_neither_saves_nor_runs(browser, serve, tmp_path):
    """In a real browser, which sends the Host and the Origin that browsers send."""
    served = serve()
    before = sorted(path.name for path in served.files.root.iterdir())
    (tmp_path / "index.html").write_text(EVIL.replace("PORT", str(served.port)))

    class Pages(http.server.SimpleHTTPRequestHandler):
        def __init__(self, *words):
            super().__init__(*words, directory=str(tmp_path))

        def log_message(self, *_):
            pass

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Pages) as site:
        threading.Thread(target=site.serve_forever, daemon=True).start()
        context = new_context(browser)
        page = context.new_page()
        page.goto(f"http://localhost:{site.server_port}/")
        page.wait_for_function("document.title === 'done'")
        seen = page.evaluate("window.seen")
        framed = page.frames[1].evaluate("document.body.innerText")
        context.close()
        site.shutdown()
    assert seen["page"] == seen["socket"] == "refused", seen
    assert "Add" not in framed, "the studio is not shown in a frame of another site"
    assert served.studio.session.viewers == []
    assert sorted(path.name for path in served.files.root.iterdir()) == before


def test_a_rebound_name_is_refused_in_both_protocols(served):
    with pytest.raises(InvalidStatus) as refused:
        connect(
            f"ws://127.0.0.1:{served.port}/studio/ws",
            additional_headers={"Host": f"rebound.example:{served.port}"},
        )
    assert refused.value.response.status_code in (400, 403)
