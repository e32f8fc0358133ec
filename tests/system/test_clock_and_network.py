"""A clock that is set back, and a network that must not be used, change nothing of a run."""

import json
import os
import subprocess
import sys

import pytest

from tests.running import run_case

SCENARIO = """\
scenario: Move and wait
robot: open_manipulator_x
steps: [{move_to: {joints: {joint1: 0.3}}}, {wait: 50 ms}]
expect: [{always: within_limits}, {duration: {at_most: 10 s}}]
"""
SITE = {
    "clock": """\
import itertools, time
backwards = (2e9 - 3600.0 * n for n in itertools.count())
time.time = lambda: next(backwards)
time.time_ns = lambda: int(next(backwards) * 1e9)
""",
    "network": """\
import os, socket, sys
def refuse(event, arguments):
    is_inet = event in ("socket.connect", "socket.bind", "socket.sendto") and (
        arguments[0].family in (socket.AF_INET, socket.AF_INET6)
    )
    if is_inet or event in ("socket.getaddrinfo", "socket.gethostbyname"):
        os.write(2, f"the network was used: {event} {arguments}\\\\n".encode())
        os._exit(99)
sys.addaudithook(refuse)
""",
}
"""What Python imports first: every look at the clock is an hour earlier; a use of the network
ends the process."""


def command(folder, site, *words):
    (folder / "sitecustomize.py").write_text(site)
    return subprocess.run(
        [sys.executable, "-m", "harness.cli", *map(str, words)],
        cwd=folder, env={**os.environ, "PYTHONPATH": str(folder)},
        capture_output=True, text=True, check=False,
    )  # fmt: skip


@pytest.mark.nightly(but=["clock"])
@pytest.mark.parametrize("site", SITE.values(), ids=SITE)
def test_a_run_has_the_digest_that_it_always_has(site, tmp_path):
    file = tmp_path / "a.scenario.yaml"
    file.write_text(SCENARIO)
    expected = run_case(file, page=False, stills=False).digest
    done = command(tmp_path, site, "run", file, "--json", "--no-page")
    assert done.returncode == 0, done.stdout + done.stderr
    [case] = json.loads(done.stdout)["cases"]
    assert case["outcome"] == "passed"
    assert case["digest"] == expected


@pytest.mark.nightly(but=["words0"])
@pytest.mark.parametrize(
    "words",
    [
        ["check", "a.scenario.yaml"],
        ["run", "a.scenario.yaml", "--bag", "-j", "2", "--repeat", "2"],
        ["describe", "a.scenario.yaml"],
        ["new", "b.scenario.yaml"],
        ["list", "robots"],
        ["course"],
    ],
)
def test_a_command_does_not_use_the_network(words, tmp_path):
    (tmp_path / "a.scenario.yaml").write_text(SCENARIO)
    done = command(tmp_path, SITE["network"], *words)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_network_would_be_noticed(tmp_path):
    script = "import socket; socket.getaddrinfo('localhost', 80)"
    (tmp_path / "sitecustomize.py").write_text(SITE["network"])
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", script], check=False, env=environment)
    assert done.returncode == 99
