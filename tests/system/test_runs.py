"""`harness run` end to end on real files: outcomes, exit codes, reports, digests, Ctrl-C."""

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from harness.cli.main import main
from tests.commands import harness
from tests.gate import PLUGIN, Gate
from tests.waiting import HANG, is_alive, wait_for

HARNESS = Path(sys.executable).parent / "harness"

SCENARIO = """\
scenario: {title}
tags: [{tag}]
robot: {robot}
steps:
  - move_to: {{joints: {{joint1: 0.3, joint2: -0.5}}}}
  - gripper: open
  - wait: {wait}
expect:
  - duration: {{at_most: 20 s}}
  - {expect}
"""
ALWAYS = "always: within_limits"
LATE = "duration: {at_least: 5000 s}"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write(name, *, title="Move", tag="a", robot="open_manipulator_x", wait="0.1 s", expect=ALWAYS):
    text = SCENARIO.format(title=title, tag=tag, robot=robot, wait=wait, expect=expect)
    file = Path(f"{name}.scenario.yaml")
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)


def write_held(name):
    write(name)
    file = Path(f"{name}.scenario.yaml")
    file.write_text(file.read_text().replace("wait: 0.1 s", Gate(Path().absolute()).step))


def run_json(*arguments, **environment):
    done = harness("run", "--json", *arguments, cwd=Path.cwd(), **environment)
    document = json.loads(done.stdout)
    assert document["exit_code"] == done.returncode
    return document


@pytest.fixture
def here(capsys):
    """Runs a command in this process: for what isolation has no part in."""

    def run(*arguments):
        code = main([*arguments])
        out, err = capsys.readouterr()
        return subprocess.CompletedProcess(arguments, code, out, err)

    return run


@pytest.fixture
def run_here(here):
    def run(*arguments):
        done = here("run", "--json", "--in-process", *arguments)
        document = json.loads(done.stdout)
        assert document["exit_code"] == done.returncode
        return document

    return run


def digests(document):
    return {Path(each["file"]).name: each["digest"] for each in document["cases"]}


def processes_below(pid):
    """Pids of all processes that a process started, and those started."""
    below, new = set(), {pid}
    while new:
        new = {child for child, parent, _group in process_table() if parent in new} - below
        below |= new
    return below


def process_table():
    """(pid, parent's pid, process group) of every process."""
    table = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            fields = stat.read_text().rpartition(")")[2].split()
            table.append((int(stat.parent.name), int(fields[1]), int(fields[2])))
    return table


def running_cases(pid):
    """Pids of the cases of a `harness run`: each leads a group, and is forked by the server."""
    servers = [child for child, parent, _group in process_table() if parent == pid]
    return [
        child for child, parent, group in process_table() if parent in servers and child == group
    ]


def test_outcomes_give_the_exit_code_and_the_failure_comes_last_with_how_to_repeat_it():
    write("good", title="Good one")
    write("late", title="Late one", expect=LATE)
    words = ("run", ".", "--seed", "5", "--set", "scenario=Late")
    done = harness(*words, cwd=Path.cwd())
    assert done.returncode == 1
    assert done.stderr == ""
    assert "\x1b" not in done.stdout
    before, after = done.stdout.split("FAILED ")
    assert "good.scenario.yaml  passed  Late  3 steps" in before
    assert "1/3" not in before  # steps are for terminals
    assert "digest" not in before
    lines = after.splitlines()
    assert lines[1].startswith("  late.scenario.yaml:10: duration")
    assert "5000" in lines[1]
    assert lines[2] == "     10 |   - duration: {at_least: 5000 s}"
    assert "  report: reports/late/report.html#t=1.39&expect=2" in lines
    assert "  again:  harness run late.scenario.yaml --set scenario=Late --seed 5" in lines
    stored = json.loads(Path("reports/late/run.json").read_text())
    assert stored["options"] == ["--set", "scenario=Late", "--seed", "5"]
    assert lines[-3].startswith("1 failed, 1 passed of 2 cases in ")
    assert lines[-2] == "2 files found, 2 collected, 2 run"


@pytest.mark.nightly
def test_the_gravest_outcome_is_the_exit_code():
    write("good")
    write("late", expect=LATE)
    write("broken", robot="no_such_robot")
    document = run_json(".")
    outcomes = [(each["file"], each["outcome"]) for each in document["cases"]]
    assert outcomes == [
        ("broken.scenario.yaml", "invalid"),
        ("good.scenario.yaml", "passed"),
        ("late.scenario.yaml", "failed"),
    ]
    assert document["exit_code"] == 2
    assert document["cases"][0]["problems"][0]["line"] == 3
    assert run_json(".", HARNESS_HARD_CAP="0.01")["exit_code"] == 3


@pytest.mark.nightly
def test_digests_are_the_same_alone_in_a_suite_side_by_side_and_in_this_process():
    for name in "abc":
        write(name, wait=f"0.{ord(name) - ord('a') + 1} s")
    write("sub/c", wait="0.3 s", title="Another title", tag="b")
    first = run_json(".")
    assert first["cases"][2]["digest"] == first["cases"][3]["digest"]
    in_suite = digests(first)
    assert len(set(in_suite.values())) == 3
    assert digests(run_json(".", "-j", "2", "--no-report")) == in_suite
    assert digests(run_json(".", "--in-process", "--no-report")) == in_suite
    assert digests(run_json("b.scenario.yaml", "--no-report")) == {
        "b.scenario.yaml": in_suite["b.scenario.yaml"]
    }


@pytest.mark.nightly
def test_repeat_says_whether_the_digests_are_the_same():
    write("a")
    done = harness("run", "a.scenario.yaml", "--repeat", "3", "-j", "2", cwd=Path.cwd())
    assert done.returncode == 0
    assert "3 runs, one digest: " in done.stdout
    document = run_json("a.scenario.yaml", "--repeat", "2")
    assert [each["report_dir"] for each in document["cases"]] == ["reports/a", ""]


@pytest.mark.nightly
def test_k_set_seed_and_report_dir_do_what_they_say(run_here):
    write("a", tag="slow")
    write("b", tag="quick", title="Move it")
    document = run_here(".", "-k", "quick and not slow", "--seed", "11", "--report-dir", "r")
    [result] = document["cases"]
    assert (result["file"], result["seed"]) == ("b.scenario.yaml", 11)
    assert Path("r/b/run.json").is_file()
    assert not Path("reports").exists()
    changed = run_here("b.scenario.yaml", "--set", "steps.2.wait=0.4 s", "--no-report")
    assert changed["cases"][0]["outcome"] == "passed"
    assert changed["cases"][0]["sim_time"] > result["sim_time"] + 0.2


def test_no_report_writes_nothing(folder, run_here):
    write("a")
    before = sorted(folder.rglob("*"))
    assert run_here("a.scenario.yaml", "--no-report")["exit_code"] == 0
    assert sorted(folder.rglob("*")) == before


@pytest.mark.nightly
def test_a_killed_child_is_an_error_and_leaves_the_others_complete():
    write_held("a")
    write("b")
    process = subprocess.Popen(
        [HARNESS, "run", ".", "--json", *PLUGIN],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    [child] = wait_for(lambda: running_cases(process.pid))
    os.kill(child, signal.SIGKILL)
    out, _err = process.communicate(timeout=HANG)
    first, second = json.loads(out)["cases"]
    assert process.returncode == 3
    assert first["outcome"] == "error"
    assert "SIGKILL (signal 9)" in first["message"]
    assert second["outcome"] == "passed"
    assert [path.name for path in Path("reports").iterdir() if path.is_dir()] == ["b"]


@pytest.mark.nightly
@pytest.mark.parametrize("workers", ["1", "2"])
def test_ctrl_c_keeps_finished_reports_and_leaves_nothing_half_written(workers):
    write("a")
    write_held("b")
    write_held("c")
    process = subprocess.Popen(
        [HARNESS, "run", ".", "-j", workers, *PLUGIN],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    before = ""
    for line in process.stdout:
        before += line
        if "passed" in line:
            break
    wait_for(lambda: running_cases(process.pid))
    below = processes_below(process.pid)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does
    out, err = process.communicate(timeout=HANG)
    assert process.returncode == 130
    assert "Traceback" not in out + err
    out = before + out
    assert re.search(r"interrupted after [\d.]+ s: 2 of 3 runs did not finish", err)
    assert "1 passed of 1 case" in out
    assert [path.name for path in Path("reports").iterdir() if path.is_dir()] == ["a"]
    assert json.loads(Path("reports/results.json").read_text())["interrupted"]
    assert json.loads(Path("reports/a/run.json").read_text())["outcome"] == "passed"
    assert len(below) >= 2
    wait_for(lambda: not any(is_alive(pid) for pid in below))


def test_a_file_with_mistakes_gets_them_all_and_exit_code_2(here):
    Path("bad.scenario.yaml").write_text(
        "scenario: Bad\nrobot: {model: open_manipulator_x, bse: 1}\nwrld: empty\nsteps:\n"
        "  - wiat: 1 s\n  - gripper: {}\n  - wait: 3 parsecs\nexpect:\n  - lifted: {}\n"
    )
    for command in (["run", "--in-process"], ["check"]):
        done = here(*command, "bad.scenario.yaml")
        assert done.returncode == 2
        for place in ("2:36", "3:1", "5:5", "6:5", "7:11", "9:5"):
            assert f"bad.scenario.yaml:{place}: " in done.stdout, (command, place)


def test_check_and_explain_run_no_physics_and_write_nothing(folder, here):
    write("a", wait="590 s", title="Long")
    before = sorted(folder.rglob("*"))
    assert here("check", "a.scenario.yaml").stdout.endswith("a.scenario.yaml: ok\n")
    explained = here("explain", "a.scenario.yaml")
    assert explained.returncode == 0
    assert "Long" in explained.stdout
    assert sorted(folder.rglob("*")) == before


def test_check_finds_a_goal_out_of_reach_before_any_motion(here):
    write("a")
    text = Path("a.scenario.yaml").read_text()
    far = "  - move_to: {position: {frame: world, xyz: [9, 0, 0]}}\n  - gripper: open"
    Path("a.scenario.yaml").write_text(text.replace("  - gripper: open", far))
    done = here("check", "a.scenario.yaml", "--json")
    [found] = json.loads(done.stdout)["files"]
    assert done.returncode == 1
    assert found["outcome"] == "failed"
    assert found["predicted"][0]["line"] == 6
    assert "NO_IK_SOLUTION" in found["predicted"][0]["message"]


def test_a_saved_run_is_judged_again_by_its_own_and_by_other_expectations(here, run_here):
    write("a")
    write("late", expect=LATE)
    run_here("a.scenario.yaml")
    again = here("judge", "reports/a", "--json")
    assert again.returncode == 0
    statuses = [each["status"] for each in json.loads(again.stdout)["verdicts"]]
    assert statuses == ["passed", "passed"]
    other = here("judge", "reports/a", "--with", "late.scenario.yaml")
    assert other.returncode == 1
    assert "5000" in other.stdout
    assert "1 of 2 expectations hold" in other.stdout


@pytest.mark.nightly
def test_a_new_scenario_passes(here, run_here):
    assert here("new", "first.scenario.yaml").returncode == 0
    assert here("check", "first.scenario.yaml").returncode == 0
    [result] = run_here("first.scenario.yaml")["cases"]
    assert result["outcome"] == "passed", result
