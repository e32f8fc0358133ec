"""The server meets raw requests of its pipe: malformed, hostile, and many at once."""

import json
import os
import subprocess
import sys
from importlib.util import find_spec

import pytest

from harness.core.limits import MCP_COMMANDS

pytestmark = pytest.mark.skipif(find_spec("mcp") is None, reason="the extra `mcp` is not installed")

INITIALIZE = {
    "protocolVersion": "2025-06-18", "capabilities": {},
    "clientInfo": {"name": "raw", "version": "1"},
}  # fmt: skip
SITE = """\
import os, sys, time
from pathlib import Path
if "harness.cli" in sys.orig_argv and "mcp" not in sys.orig_argv:
    started = Path(os.environ["STARTED"])
    (started / str(os.getpid())).touch()
    time.sleep(0.3)
    running = len(list(started.iterdir()))
    (started.parent / "most").open("a").write(f"{running}\\n")
    (started / str(os.getpid())).unlink()
    os._exit(0)
"""
"""Every command of the server counts how many run next to it, and ends."""


class Server:
    """`harness mcp` as a process, and the lines of its two pipes."""

    def __init__(self, folder, **environment):
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "harness.cli", "mcp", "--root", str(folder)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
            env={**os.environ, **environment},
        )  # fmt: skip
        self.request(0, "initialize", **INITIALIZE)
        assert self.answer(0)["result"]["serverInfo"]["name"] == "armharness"
        self.send({"jsonrpc": "2.0", "method": "notifications/initialized"})

    def send(self, message):
        line = message if isinstance(message, bytes) else json.dumps(message).encode()
        self._process.stdin.write(line + b"\n")
        self._process.stdin.flush()

    def request(self, number, method, **params):
        self.send({"jsonrpc": "2.0", "id": number, "method": method, "params": params})

    def call(self, number, tool, **arguments):
        self.request(number, "tools/call", name=tool, arguments=arguments)

    def answer(self, number):
        """The answer of a request, those before it passed over."""
        while (message := self.next()).get("id") != number:
            pass
        return message

    def next(self):
        """The next message."""
        line = self._process.stdout.readline()
        assert line, "the server ended"
        return json.loads(line)

    def close(self):
        self._process.stdin.close()
        code = self._process.wait()
        self._process.stdout.close()
        return code


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    root = tmp_path_factory.mktemp("strangers") / "root"
    root.mkdir()
    (root.parent / "evil.py").write_text("import pathlib\npathlib.Path('imported').touch()\n")
    server = Server(root)
    server.root = root
    yield server
    assert server.close() == 0


LINES = {
    "nothing": b"",
    "no JSON": b"GET / HTTP/1.1",
    "no UTF-8": b"\xff\xfe\x00",
    "deep": b"[" * 50_000,
    "a list": b"[]",
    "a method that is a number": b'{"jsonrpc": "2.0", "id": 7, "method": 5}',
    "an id that is an object": b'{"jsonrpc": "2.0", "id": {"a": 1}, "method": "tools/call"}',
    "a tool that is a list": b'{"jsonrpc": "2.0", "id": 8, "method": "tools/call",'
    b' "params": {"name": []}}',
    "half a character": b'{"jsonrpc": "2.0", "id": 9, "method": "tools/call",'
    b' "params": {"name": "read", "arguments": {"file": "\\ud800"}}}',
    "a long line": b'{"jsonrpc": "2.0", "method": "' + b"x" * 5_000_000 + b'"}',
}  # fmt: skip


@pytest.mark.parametrize("line", LINES.values(), ids=LINES)
def test_a_malformed_line_costs_nothing_else(server, line):
    server.send(line)
    server.call(100, "read", file="absent.yaml")
    assert server.answer(100)["result"]["isError"]
    assert not list(server.root.iterdir())


@pytest.mark.nightly(only=[12, 13])
@pytest.mark.parametrize(
    ("tool", "arguments"),
    [
        ("read", {"file": "../../etc/passwd"}),
        ("read", {"file": "-h.yaml"}),
        ("read", {"file": "/proc/self/environ"}),
        ("write", {"file": "../out.yaml", "text": "x"}),
        ("write", {"file": "a.py", "text": "x"}),
        ("write", {"file": "a.yaml", "text": 5}),
        ("write", {"file": "a.yaml", "text": "x" * 200_001}),
        ("picture", {"report": "../..", "step": "../../x"}),
        ("check", {"file": "--help"}),
        ("run", {"file": "x", "seed": "; touch y"}),
        ("list", {"kind": "--help"}),
        ("list", {"kind": "--plugin=../evil.py"}),
        ("schema", {"name": "--plugin=../evil.py"}),
        ("run", {"file": "lessons/04_gripper_alone", "case": "x --plugin=../evil.py"}),
        ("__init__", {}),
        ("eval", {"text": "1"}),
    ],
)
def test_a_hostile_call_is_an_error_and_leaves_no_file(server, tool, arguments):
    server.call(101, tool, **arguments)
    message = server.answer(101)
    assert "error" in message or message["result"]["isError"]
    assert not list(server.root.iterdir())
    assert not (server.root.parent / "out.yaml").exists()


def test_the_name_of_a_file_is_never_an_option(server):
    """A file that is called like an option with a plug-in."""
    server.call(102, "write", file="--plugin=..", text="x")
    assert server.answer(102)["result"]["isError"]
    server.call(103, "write", file="--plugin=evil.scenario.yaml", text="scenario: x\n")
    [case] = json.loads(server.answer(103)["result"]["content"][0]["text"])
    assert case["outcome"] == "invalid"
    assert case["file"].endswith("--plugin=evil.scenario.yaml")
    assert [each.name for each in server.root.iterdir()] == ["--plugin=evil.scenario.yaml"]
    (server.root / "--plugin=evil.scenario.yaml").unlink()


@pytest.mark.nightly
def test_many_calls_at_once_run_few_commands_at_the_same_time(tmp_path):
    (tmp_path / "started").mkdir()
    (tmp_path / "site").mkdir()
    (tmp_path / "site/sitecustomize.py").write_text(SITE)
    root = tmp_path / "root"
    root.mkdir()
    server = Server(root, PYTHONPATH=str(tmp_path / "site"), STARTED=str(tmp_path / "started"))
    for number in range(1, 13):
        server.call(number, "list")
    waiting = set(range(1, 13))
    while waiting:
        waiting.discard(server.next()["id"])
    assert server.close() == 0
    counts = [int(line) for line in (tmp_path / "most").read_text().split()]
    assert len(counts) == 12
    assert max(counts) <= MCP_COMMANDS
