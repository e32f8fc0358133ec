"""The page of a suite exists while the suite runs."""

import base64
import gzip
import os
import re
import subprocess
import sys
import time

import pytest

from tests.suite.ball import ball

REFRESH = '<meta http-equiv="refresh"'


def run(folder, *words):
    return subprocess.Popen(
        [sys.executable, "-m", "harness.cli", "run", "ball.scenario.yaml", "--no-page", *words],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=os.environ.copy(),
    )  # fmt: skip


def first_page(folder, running):
    page = folder / "reports/index.html"
    while running.poll() is None:
        if page.exists():
            return page.read_text()
        time.sleep(0.005)
    raise AssertionError("there was no page before the end")


def test_a_running_suite_has_a_page_that_reloads_and_the_last_page_does_not(tmp_path):
    (tmp_path / "ball.scenario.yaml").write_text(ball(9))
    running = run(tmp_path)
    early = first_page(tmp_path, running)
    assert REFRESH in early
    assert re.search("running: [1-8] of 9 runs done", early)
    assert early.endswith("</html>\n")
    running.communicate()
    assert running.returncode == 0
    last = (tmp_path / "reports/index.html").read_text()
    assert REFRESH not in last
    data = gzip.decompress(base64.b64decode(re.search(r'id="data">([^<]*)<', last)[1]))
    assert data.count(b'"outcome"') == 9


@pytest.mark.nightly
def test_the_page_of_a_suite_that_goes_on_counts_what_was_known(tmp_path):
    (tmp_path / "ball.scenario.yaml").write_text(ball(9))
    run(tmp_path).communicate()
    lines = (tmp_path / "reports/results.jsonl").read_bytes().splitlines(keepends=True)
    (tmp_path / "reports/results.jsonl").write_bytes(b"".join(lines[:5]))
    (tmp_path / "reports/index.html").unlink()
    running = run(tmp_path, "--resume")
    assert re.search("running: [5-8] of 9 runs done", first_page(tmp_path, running))
    running.communicate()
    assert running.returncode == 0
