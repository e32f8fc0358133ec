import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from harness.core.errors import HarnessError
from harness.session.run_request import RunRequest
from harness.suite.cases import read_ahead, run_here, run_isolated
from harness.suite.warm import ServerStartError, WarmServer
from tests.commands import servers_are
from tests.suite import jobs
from tests.waiting import HANG, is_alive, wait_for

LIGHT = ("json",)


@pytest.fixture(autouse=True)
def _started():
    """Start servers here as a user's command does."""
    with servers_are("started"):
        yield


@pytest.fixture
def server():
    with WarmServer(LIGHT) as server:
        yield server


def outcome(server, function, file="a.scenario.yaml", **options):
    [(_index, result)] = run_isolated(
        [RunRequest(Path(file))], server, function=function, **options
    )
    return result


def wait_until_gone(pid):
    wait_for(lambda: not is_alive(pid))


def wait_for_text(file):
    return wait_for(lambda: file.exists() and file.read_text())


def test_every_case_has_a_process_of_its_own(server):
    cases = [RunRequest(Path(f"{name}.scenario.yaml")) for name in "abc"]
    digests = {
        result.digest for _index, result in run_isolated(cases, server, function=jobs.passes)
    }
    assert len(digests) == 3
    assert f"pid {os.getpid()}" not in digests


@pytest.mark.nightly
def test_a_case_in_this_process_reports_the_same(server):
    def without_pid(results):
        return [(index, result.file, result.outcome) for index, result in results]

    cases = [RunRequest(Path("a.scenario.yaml"))]
    here = without_pid(run_here(cases, function=jobs.passes))
    assert here == without_pid(run_isolated(cases, server, function=jobs.passes))


def test_progress_of_a_running_case_is_heard(server):
    heard = []
    outcome(server, jobs.passes, watch=lambda index, event: heard.append((index, event.step)))
    assert heard == [(0, "move_to a.scenario")]


def test_results_come_as_cases_end_and_carry_their_index(server, tmp_path):
    files = [tmp_path / name for name in "abc"]
    cases = [RunRequest(file) for file in files]
    function = jobs.passes_when_its_file_exists
    for file in files[1:]:
        file.touch()
    side_by_side = []
    for index, _ in run_isolated(cases, server, workers=2, function=function):
        side_by_side.append(index)
        if len(side_by_side) == 2:
            files[0].touch()
    one_by_one = [index for index, _ in run_isolated(cases, server, function=function)]
    assert sorted(side_by_side[:2]) == [1, 2]
    assert side_by_side[2] == 0
    assert one_by_one == [0, 1, 2]


def test_an_exception_is_an_error_with_its_traceback(server):
    result = outcome(server, jobs.raises)
    assert result.outcome == "error"
    assert "ZeroDivisionError: one by nothing" in result.message
    [(_index, here)] = run_here([RunRequest(Path("a"))], function=jobs.raises)
    assert here.outcome == "error"
    assert "ZeroDivisionError: one by nothing" in here.message


def test_a_crash_is_an_error_that_names_signal_step_and_last_words(server):
    result = outcome(server, jobs.segfaults)
    assert result.outcome == "error"
    first_line = result.message.splitlines()[0]
    assert first_line == (
        "its process was ended by SIGSEGV (signal 11) during step 3/5: move_to a.scenario"
    )
    assert "last words" in result.message
    assert "jobs.py" in result.message  # the Python line that called into the native code


def test_a_killed_case_is_an_error_and_the_others_go_on(server):
    functions = {"a": jobs.kills_itself, "b": jobs.passes}
    results = {name: outcome(server, function) for name, function in functions.items()}
    assert results["a"].outcome == "error"
    assert "SIGKILL (signal 9)" in results["a"].message
    assert results["b"].outcome == "passed"


def test_a_process_that_leaves_without_a_result_is_an_error(server):
    assert outcome(server, jobs.leaves_without_a_result).outcome == "error"


@pytest.mark.nightly
def test_an_endless_native_call_ends_as_an_error_at_the_hard_cap(server):
    result = outcome(server, jobs.never_returns_from_native_code, hard_cap=3.0)
    assert result.outcome == "error"
    assert result.message.startswith(
        "no end after 3 s of wall time during step 3/5: move_to a.scenario; stopped by"
    )


@pytest.mark.nightly
def test_the_hard_cap_does_not_count_waits_for_a_processor(server):
    code = "import os\nos.sched_setaffinity(0, {min(os.sched_getaffinity(0))})\nwhile True: pass"
    others = [subprocess.Popen([sys.executable, "-c", code]) for _ in range(4)]
    try:
        result = outcome(server, jobs.computes_on_a_busy_processor, hard_cap=1.0)
    finally:
        for each in others:
            each.kill()
            each.wait()
    assert result.outcome == "passed"


def test_an_endless_computation_ends_at_the_hard_cap(server):
    result = outcome(server, jobs.computes_without_end, hard_cap=0.5)
    assert result.message.startswith("no end after 0.5 s of wall time")


def test_the_hard_cap_can_come_from_the_environment(server, monkeypatch):
    monkeypatch.setenv("HARNESS_HARD_CAP", "0.25")
    assert "after 0.25 s" in outcome(server, jobs.never_returns_from_native_code).message


def test_what_a_case_leaves_running_ends_with_it(server, tmp_path):
    file = tmp_path / "pid"
    assert outcome(server, jobs.leaves_a_process_running, file=file).outcome == "passed"
    wait_until_gone(int(file.read_text()))


def test_a_case_does_not_wait_for_what_it_leaves_running_in_another_session(server, tmp_path):
    file = tmp_path / "pid"
    assert outcome(server, jobs.leaves_a_session_running, file=file).outcome == "passed"
    child = int(file.read_text())
    assert is_alive(child)
    os.kill(child, signal.SIGKILL)


def test_what_a_case_prints_stays_out_of_this_process(server, capfd):
    result = outcome(server, jobs.prints)
    assert result.outcome == "passed"
    assert result.title == ""  # it had nothing to read either
    assert capfd.readouterr() == ("", "")


def test_closing_the_server_ends_running_cases(tmp_path):
    file = tmp_path / "pid"
    with WarmServer(LIGHT) as server:
        server.start(jobs.reports_its_pid_and_sleeps, RunRequest(file))
        pid = int(wait_for_text(file))
        assert is_alive(pid)
    wait_until_gone(pid)


def test_a_caller_that_is_killed_leaves_no_process(tmp_path):
    file = tmp_path / "pid"
    code = (
        "import sys; from pathlib import Path; from tests.suite import jobs\n"
        "from harness.suite.cases import *\n"
        "server = WarmServer(('json',))\n"
        "list(run_isolated([RunRequest(Path(sys.argv[1]))], server,"
        " function=jobs.reports_its_pid_and_sleeps))\n"
    )
    root = Path(__file__).parents[2]
    caller = subprocess.Popen([sys.executable, "-c", code, str(file)], cwd=root)
    pid = int(wait_for_text(file))
    caller.send_signal(signal.SIGKILL)
    caller.wait()
    wait_until_gone(pid)


def test_a_server_that_dies_makes_its_cases_errors_and_leaves_no_process(server, tmp_path):
    file = tmp_path / "pid"
    number = server.start(jobs.reports_its_pid_and_sleeps, RunRequest(file))
    pid = int(wait_for_text(file))
    os.kill(server.pid, signal.SIGKILL)
    ended = []
    while not ended:
        ended = list(server.wait(HANG))
    assert (ended[0].job, ended[0].code) == (number, None)
    wait_until_gone(pid)
    assert outcome(server, jobs.passes).outcome == "passed"  # on a new server


def test_a_missing_module_is_reported_by_name():
    with (
        WarmServer(("json", "no_such_module_at_all")) as server,
        pytest.raises(ServerStartError, match="No module named 'no_such_module_at_all'") as caught,
    ):
        outcome(server, jobs.passes)
    assert isinstance(caught.value, HarnessError)


def test_server_and_child_have_one_thread_with_every_solver_imported():
    modules = ("numpy", "mujoco", "pinocchio", "coal", "ompl.base")
    with WarmServer(modules) as server:
        assert outcome(server, jobs.counts_threads).title == "1 1"


def test_every_child_finds_what_the_server_has_prepared(server):
    server.prepare(jobs.remember, "this")
    assert outcome(server, jobs.reports_what_is_remembered).title == "this"
    server.prepare(jobs.remember, "and that")
    assert outcome(server, jobs.reports_what_is_remembered).title == "this and that"


def test_a_preparation_that_fails_leaves_the_server_at_work(server):
    server.prepare(jobs.remember, "this")
    server.prepare(jobs.forget_by_mistake)
    assert outcome(server, jobs.reports_what_is_remembered).title == ""


def test_bundled_robots_that_scenarios_name_are_read_once_for_all(server):
    server.prepare(read_ahead, frozenset({"Pick", "open_manipulator_x", "rh_p12_rn_a"}))
    assert outcome(server, jobs.reports_robots_already_read).title == "2"


def test_models_of_scenarios_and_their_steps_are_built_once_for_all(server):
    assert outcome(server, jobs.reports_models_already_built).title == ""
    server.prepare(read_ahead, frozenset({"Pick", "gripper"}))
    assert outcome(server, jobs.reports_models_already_built).title == "Scenario Gripper"
