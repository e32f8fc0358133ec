"""`harness run --live`: a page shows the cases while they run, and changes nothing of them."""

import json
import os
import re
import signal
import subprocess
import sys
import threading
from dataclasses import replace
from multiprocessing.connection import Listener

import pytest
from websockets.sync.client import connect

from harness.session.run_request import RunRequest
from harness.suite.cases import run_job
from tests.plugins.studio.test_studio_page import Page
from tests.reporting.browser import new_context

pytest.importorskip("django_static_ace_builds")
from harness.plugins.studio.watch import Watch
from harness.reporting.progress_events import StepStarted

TEXT = """\
scenario: watched
robot: open_manipulator_x
objects:
  - {name: box, box: {size: [0.03, 0.03, 0.03]}, pose: {xyz: [0.2, 0, 0.015]}}
  - name: wall
    box: {size: [0.1, 0.1, 0.1]}
    pose: {xyz: [0.5, 0, 0.05]}
    static: true
    in: planning
steps:
  - ptp: {joints: {joint1: 0.3}}
    expect: [{joints: {positions: {joint1: 0.3}}}]
  - wait: 30 s
"""


@pytest.fixture(scope="module")
def request_(tmp_path_factory):
    file = tmp_path_factory.mktemp("watch") / "watched.scenario.yaml"
    file.write_text(TEXT)
    return RunRequest(file)


@pytest.fixture(scope="module")
def unwatched(request_):
    return run_job(request_, lambda _: None)


def in_thread(request, results, notify=lambda _: None):
    thread = threading.Thread(target=lambda: results.append(run_job(request, notify)))
    thread.start()
    return thread


def test_the_page_shows_the_case_while_it_runs(browser, request_, unwatched):
    results, drawn = [], []
    was_seen = threading.Event()

    def hold_second_step(event):
        if isinstance(event, StepStarted) and event.index == 1:
            was_seen.wait()

    context, closed = new_context(browser), new_context(browser)
    with Watch() as watch:
        opened = Page(context, watch.page, is_live=False)
        second = Page(closed, watch.page, is_live=False)
        opened.wait_text("#status", "waiting for the first case")
        view = watch._view  # noqa: SLF001 - what the scene is given
        move = view.move
        view.move = lambda where, objects, more: (drawn.append(objects), move(where, objects, more))
        thread = in_thread(replace(request_, live=watch.address), results, hold_second_step)
        try:
            opened.wait_text("#status", "1 of 2 steps; wait 30 s")
            second.wait_text("#status", "1 of 2 steps; wait 30 s")
            closed.close()
        finally:
            was_seen.set()
        thread.join()
        opened.wait_text("#verdicts", "joints")
        opened.wait_text("#status", "watched.scenario.yaml: passed")
        opened.wait("parseFloat(document.querySelector('#clock').innerText) > 0")
        opened.page.select_option("#case", "1")
    opened.wait_text("#status", "The run has ended")
    assert opened.complaints == []
    context.close()
    assert drawn
    assert set(drawn[-1]) >= {"box", "wall"}, "what only the planner knows is shown too"
    assert results[0].digest == unwatched.digest


@pytest.mark.nightly
def test_who_does_not_read_what_is_sent_delays_nothing(request_, unwatched, tmp_path):
    with Listener(str(tmp_path / "s"), "AF_UNIX") as listener:
        results = []
        thread = in_thread(replace(request_, live=listener.address), results)
        connection = listener.accept()
        thread.join()
        assert results[0].digest == unwatched.digest
        connection.close()


@pytest.mark.nightly
def test_a_page_that_is_gone_changes_nothing(request_, unwatched, tmp_path):
    result = run_job(replace(request_, live=str(tmp_path / "gone")), lambda _: None)
    assert result.digest == unwatched.digest


@pytest.mark.nightly
def test_the_command_prints_the_address_and_ends_with_the_run(request_, unwatched):
    command = [sys.executable, "-m", "harness.cli", "run", request_.file.name, "--live"]
    command += ["--no-report", "-j", "2", "--repeat", "2"]
    folder = request_.file.parent
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr.count("\n")) == (0, 1)
    assert re.match(r"live: http://127.0.0.1:\d+/\n", done.stderr)
    assert f"2 runs, one digest: {unwatched.digest}" in done.stdout


@pytest.mark.nightly
def test_ctrl_c_ends_a_run_that_two_pages_watch(tmp_path):
    text = TEXT.replace("30 s", "590 s")
    (tmp_path / "long.scenario.yaml").write_text(text)
    command = [sys.executable, "-m", "harness.cli", "run", "long.scenario.yaml", "--live"]
    pipe = subprocess.PIPE
    with subprocess.Popen(
        command, cwd=tmp_path, stdout=pipe, stderr=pipe, text=True, start_new_session=True
    ) as process:
        port = re.search(r":(\d+)/", process.stderr.readline())[1]
        address = f"ws://127.0.0.1:{port}/studio/ws"
        with connect(address) as first, connect(address) as second:
            for page in (first, second):
                page.send(json.dumps({"page": str(id(page))}))
            for page in (first, second):
                while json.loads(page.recv()).get("doing") != "wait 590 s":
                    pass
            os.killpg(process.pid, signal.SIGINT)
            _, said = process.communicate()
    assert process.returncode == 130
    assert "during step 2/2: wait 590 s: the run did not finish, and no report was written" in said
    assert "Traceback" not in said
    assert [each.name for each in tmp_path.iterdir()] == ["long.scenario.yaml"]


def test_options_that_have_no_poses_here_are_refused(request_):
    command = [sys.executable, "-m", "harness.cli", "run", str(request_.file), "--live"]
    done = subprocess.run([*command, "--on", "ray"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (2, "harness: --live and --on exclude each other\n")
