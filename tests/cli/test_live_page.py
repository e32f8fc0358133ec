"""The page of a suite exists while the suite runs."""

import base64
import gzip
import os
import re
import subprocess
import sys

import pytest

from tests.gate import PLUGIN, Gate
from tests.suite.ball import ball
from tests.waiting import wait_for

REFRESH = '<meta http-equiv="refresh"'


def gated_balls(folder):
    gate = Gate(folder)
    text = ball(9).replace("wait: 2 ms", gate.step)
    (folder / "ball.scenario.yaml").write_text(text)
    return gate


def run(folder, *words):
    return subprocess.Popen(
        [sys.executable, "-m", "harness.cli", "run", "ball.scenario.yaml", "--no-page",
         *PLUGIN, *words], cwd=folder,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=os.environ.copy(),
    )  # fmt: skip


def page_of(folder, running):
    page = folder / "reports/index.html"
    wait_for(lambda: page.exists() or running.poll() is not None)
    return page.read_text()


def test_a_running_suite_has_a_page_that_reloads_and_the_last_page_does_not(tmp_path):
    gate = gated_balls(tmp_path)
    gate.let_pass(1)
    running = run(tmp_path)
    early = page_of(tmp_path, running)
    gate.let_pass(9)
    assert REFRESH in early
    assert "running: 1 of 9 runs done" in early
    assert early.endswith("</html>\n")
    running.communicate()
    assert running.returncode == 0
    last = (tmp_path / "reports/index.html").read_text()
    assert REFRESH not in last
    data = gzip.decompress(base64.b64decode(re.search(r'id="data">([^<]*)<', last)[1]))
    assert data.count(b'"outcome"') == 9


@pytest.mark.nightly
def test_the_page_of_a_suite_that_goes_on_counts_what_was_known(tmp_path):
    gate = gated_balls(tmp_path)
    gate.let_pass(9)
    run(tmp_path).communicate()
    lines = (tmp_path / "reports/results.jsonl").read_bytes().splitlines(keepends=True)
    (tmp_path / "reports/results.jsonl").write_bytes(b"".join(lines[:5]))
    (tmp_path / "reports/index.html").unlink()
    gate.let_pass(10)
    running = run(tmp_path, "--resume")
    assert re.search("running: [5-8] of 9 runs done", page_of(tmp_path, running))
    gate.let_pass(18)
    running.communicate()
    assert running.returncode == 0
