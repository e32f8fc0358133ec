"""`harness grade --node`, `bridge` and `replay` at the command line."""

import json
import re
import shutil
import signal
import sys
from pathlib import Path
from threading import Thread

import pytest

from harness.cli.main import main
from harness.plugins.ros.domain import free_domain
from tests.plugins.ros.bridging import scenario
from tests.plugins.ros.nodes import Node
from tests.session.front_door import problems

HERE = Path(__file__).parent
BOX = "ros2/01_lift_the_red_box"
ELSEWHERE = """
import os
from tests.plugins.ros.nodes import Node, follow, point
node = Node(int(os.environ["ROS_DOMAIN_ID"]))
node.ready()
assert node.send(follow(point(2, [-0.6, 0.0, 0.0, 0.0]))).result.error_code == 0
"""
LIFT = f"{sys.executable} {HERE / 'lift_the_box.py'}"


@pytest.fixture(autouse=True)
def _importable(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(HERE.parents[2]))


def json_of(capsys, *arguments):
    code = main([*arguments, "--json"])
    return code, json.loads(capsys.readouterr().out)


def test_a_node_earns_the_points_of_the_lesson_and_its_commands_replay(tmp_path, capsys):
    options = ["--pace", "3", "--no-page", "--report-dir", str(tmp_path)]
    options += ["--set", "steps.exercise.timeout=590"]  # of simulated time, which does not wait
    code, graded = json_of(capsys, "grade", BOX, "--node", LIFT, *options)
    assert [(row["verdict"]["status"], row["earned"]) for row in graded["rows"]] == [
        ("passed", points) for points in (1, 2, 2, 3, 1, 1)
    ]
    assert (code, graded["earned"], graded["points"]) == (0, 10, 10)
    [folder] = [path.parent for path in tmp_path.rglob("run.json")]
    code, replayed = json_of(capsys, "replay", str(folder))
    assert (code, replayed["is_equal"], replayed["commands"]) == (0, True, 4)
    record = json.loads((folder / "run.json").read_text())
    kinds = [command["kind"] for command in record["commands"]]
    assert kinds == ["gripper", "trajectory", "gripper", "trajectory"]


def grade(capsys, *arguments):
    code = main(["grade", *arguments])
    return code, capsys.readouterr()


@pytest.mark.nightly
def test_a_node_that_crashes_ends_the_step_and_shows_what_it_printed(capsys):
    code, said = grade(capsys, BOX, "--node", f"{LIFT} --crash", "--no-report")
    assert code == 1, said.out
    assert "TIMED_OUT: `until` did not become true: the node ended" in said.out
    assert "the launched program ended with exit code 1" in said.out
    assert "no idea how this works" in said.err


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ([], "give either a recording (BAG) or a command (--node)"),
        (["a.mcap", "--node", "x"], "give either a recording (BAG) or a command (--node)"),
        (["--node", "student="], "has no command"),
        (["--node", "a", "--node", "b"], "two commands are called 'node'"),
        (["--node", "x", "--domain", "400"], "'400' is no domain; they are 0 to 232"),
    ],
)
def test_wrong_usage_is_explained(tmp_path, capsys, arguments, reason):
    assert main(["grade", BOX, *arguments, "--report-dir", str(tmp_path)]) == 2
    assert reason in capsys.readouterr().err


def test_a_node_that_crashes_after_its_work_is_mentioned(tmp_path, capsys):
    file, node = scenario(tmp_path, "- external: {}"), tmp_path / "node.py"
    node.write_text("print('done'); raise SystemExit(3)")
    assert main(["grade", str(file), "--node", f"{sys.executable} {node}", "--no-report"]) == 0
    said = capsys.readouterr().err
    assert "note: the launched program ended with exit code 3" in said
    assert "  done" in said


@pytest.mark.nightly
def test_points_do_not_hide_a_step_that_failed(tmp_path, capsys):
    file = scenario(tmp_path)
    (tmp_path / "elsewhere.py").write_text(ELSEWHERE, encoding="utf-8")
    node = f"{sys.executable} {tmp_path / 'elsewhere.py'}"
    command = ["--node", node, "--no-page", "--report-dir", str(tmp_path / "r")]
    code, said = grade(capsys, str(file), *command)
    assert code == 1
    assert "1 of 1 points\nnot passed: every point is earned, but a step failed" in said.out


def test_a_command_that_cannot_be_started_is_named(capsys):
    main(["grade", BOX, "--node", "/no/such/program", "--no-report"])
    assert "`/no/such/program` cannot be started: No such file" in capsys.readouterr().out


@pytest.mark.nightly
def test_a_scenario_starts_only_what_the_user_allowed(tmp_path, capsys):
    file = scenario(tmp_path, "- external: {launch: student}")
    main(["grade", str(file), "--node", "teacher=true", "--no-report"])
    assert "give it with --node 'student=COMMAND'; allowed: teacher" in capsys.readouterr().out


def test_without_nodes_a_run_says_which_command_to_use(tmp_path, capsys):
    assert main(["run", str(scenario(tmp_path)), "--no-report", "--in-process"]) == 1
    assert "harness grade SCENARIO --node COMMAND" in re.sub(r"\s+", " ", capsys.readouterr().out)


@pytest.mark.nightly
def test_a_planned_lesson_is_handed_over_as_a_whole(tmp_path, capsys):
    steps = "- wait: 1 s\n  expect: [{always: within_limits}]"
    file = scenario(tmp_path, steps)
    code, graded = json_of(
        capsys, "grade", str(file), "--node", "true", "--report-dir", str(tmp_path / "r")
    )
    assert (code, graded["points"], graded["earned"]) == (0, 1, 1)


def test_an_end_that_is_measured_after_the_run_is_refused(tmp_path):
    steps = "- external: {until: {clearance: {between: [robot, any], at_least: 1 cm}}}"
    [(line, message)] = problems(tmp_path, steps)
    assert line == 5
    assert "measured after the run" in message


@pytest.mark.nightly
@pytest.mark.parametrize("step", ["wait: 10 ms", "move_to: {joints: {joint1: 0.1}}"])
def test_a_run_without_nodes_has_nothing_to_replay(tmp_path, capsys, step):
    file = scenario(tmp_path, f"- {step}")
    main(["run", str(file), "--report-dir", str(tmp_path / "r"), "--in-process", "--no-page"])
    [folder] = [path.parent for path in (tmp_path / "r").rglob("run.json")]
    capsys.readouterr()
    assert main(["replay", str(folder)]) == 2
    assert "has no recorded commands of ROS 2 nodes" in capsys.readouterr().err
    assert main(["run", str(folder / "scenario.resolved.yaml"), "--no-report"]) == 0
    shutil.rmtree(folder)
    assert main(["replay", str(folder)]) == 2


@pytest.mark.nightly
@pytest.mark.parametrize("timeout", ["20 ms", "300"])
def test_a_step_of_nodes_that_no_node_took_has_nothing_to_replay(tmp_path, capsys, timeout):
    """Five minutes of simulated time would pass before that shows."""
    file = scenario(tmp_path, f"- external: {{}}\n  timeout: {timeout}")
    main(["run", str(file), "--report-dir", str(tmp_path / "r"), "--in-process", "--no-page"])
    [folder] = [path.parent for path in (tmp_path / "r").rglob("run.json")]
    assert main(["replay", str(folder)]) == 2
    assert "has no recorded commands of ROS 2 nodes" in capsys.readouterr().err


def test_ctrl_c_ends_a_served_session_which_is_then_judged(tmp_path, capsys):
    file = scenario(tmp_path, "- external: {}")
    with free_domain() as domain:
        node = Node(domain)

        def press_ctrl_c():
            node.ready()
            signal.raise_signal(signal.SIGINT)

        person = Thread(target=press_ctrl_c)
        person.start()
        assert main(["bridge", str(file), "--domain", str(domain), "--no-report"]) == 0
        person.join()
        node.graph.close()
    assert "1 of 1 expectation holds" in capsys.readouterr().out


@pytest.mark.nightly
def test_nodes_that_commanded_nothing_are_replayed(tmp_path, capsys):
    file = scenario(tmp_path, "- external: {}\n  timeout: 20 ms")
    main(["grade", str(file), "--node", "true", "--report-dir", str(tmp_path / "r")])
    [folder] = [path.parent for path in (tmp_path / "r").rglob("run.json")]
    capsys.readouterr()
    assert main(["replay", str(folder)]) == 0
    assert "0 commands replayed" in capsys.readouterr().out
