"""The core without the folder `harness/plugins`."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from harness.core.registry import registry

ROOT = Path(__file__).parents[2]
OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
ABSENT = ("studio", "bridge", "grade", "ik-test", "search", "import", "results")

SERVE = """
import json, os, sys
import harness.cli.main, harness.session.predict, harness.session.run_case
for line in sys.stdin:
    pid = os.fork()
    if pid == 0:
        for name, number in (("out", 1), ("err", 2)):
            os.dup2(os.open(name, os.O_CREAT | os.O_WRONLY | os.O_TRUNC), number)
        sys.argv[:] = ["harness", *json.loads(line)]
        harness.cli.main.entry()
        os._exit(0)
    print(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]), flush=True)
"""
"""Each command is forked from a process that has the libraries."""


@pytest.fixture(scope="module")
def core(tmp_path_factory):
    """A tree without plug-ins, as a function that runs `harness` in it."""
    tree = tmp_path_factory.mktemp("core")
    ignored = shutil.ignore_patterns("plugins")
    for name in ("harness", "robots", "worlds", "scenarios"):
        shutil.copytree(ROOT / name, tree / name, ignore=ignored)

    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    environment = {**os.environ, "PYTHONPATH": str(tree)}
    command = [sys.executable, "-c", SERVE]

    with subprocess.Popen(command, cwd=tree, env=environment, **pipes) as server:

        def harness(*words):
            print(json.dumps([*map(str, words)]), file=server.stdin, flush=True)
            code = int(server.stdout.readline())
            texts = [(tree / name).read_text(encoding="utf-8") for name in ("out", "err")]
            return subprocess.CompletedProcess(words, code, *texts)

        yield harness


def test_the_help_of_the_core_has_fewer_commands(core):
    done = core("--help")
    assert (done.returncode, done.stderr) == (0, "")
    shown = [line.split()[0] for line in done.stdout.splitlines() if line.startswith("    ")]
    assert {"run", "check", "view"} <= {*shown}
    assert {*shown} == {*registry("command")} - {
        name for name in registry("command") if "plugins" in registry("command").module_of(name)
    }
    for name in ABSENT:
        refused = core(name)
        assert refused.returncode == 2
        assert f"'{name}' is not valid" in refused.stderr
        assert "lacks the built-in plug-ins" in refused.stderr
        assert "Traceback" not in refused.stderr


def test_the_core_lists_no_packages_of_plug_ins(core):
    done = core("list", "plugins")
    assert (done.returncode, done.stdout.strip()) == (0, "")
    assert done.stderr.count("lacks the built-in plug-ins") == 1
    assert "Traceback" not in done.stderr


def test_the_core_checks_the_lessons_of_urdf_robots_and_runs_one(core, tmp_path):
    lessons = sorted((ROOT / "scenarios/lessons").glob("*.scenario.yaml"))
    of_urdf = [
        f"scenarios/lessons/{file.name}" for file in lessons if "ur3e" not in file.read_text()
    ]
    assert len(of_urdf) == 3
    done = core("check", *of_urdf)
    assert done.returncode == 0, done.stdout + done.stderr
    lesson = "scenarios/lessons/04_gripper_alone.scenario.yaml"
    done = core("run", lesson, "--report-dir", tmp_path, "--in-process")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "no pictures of steps" in done.stdout  # pictures are drawn by a plug-in
    assert [*tmp_path.rglob("report.html")]


@pytest.mark.nightly
def test_a_robot_in_xacro_is_refused_by_the_core(core, tmp_path):
    done = core("check", "scenarios/lessons/03_ur_sixteen_steps.scenario.yaml")
    assert done.returncode == 2
    assert "ur.urdf.xacro:6:2" in done.stdout + done.stderr
    assert "no plug-in renders xacro" in done.stdout + done.stderr
    assert "lacks the built-in plug-ins" in done.stdout + done.stderr
    shutil.copytree(ROOT / "robots/open_manipulator_x", tmp_path / "arm")
    srdf = next((tmp_path / "arm").glob("*.srdf"))
    srdf.write_text(srdf.read_text().replace("</robot>", "<xacro:nothing/></robot>"))
    file = tmp_path / "t.scenario.yaml"
    file.write_text("scenario: t\nrobot: {model: arm}\nsteps: [{wait: 1}]\n")
    done = core("check", file)
    assert done.returncode == 2
    assert f"{srdf.name}:" in done.stdout + done.stderr
    assert "no plug-in renders xacro" in done.stdout + done.stderr


def test_a_failed_motion_of_the_core_has_its_error_and_no_stages(core, tmp_path):
    file = tmp_path / "far.scenario.yaml"
    file.write_text(
        "scenario: t\nrobot: open_manipulator_x\nsteps: [{move_to: {position: [3, 0, 0]}}]\n"
    )
    done = core("run", file, "--no-report", "--in-process")
    assert done.returncode == 1
    assert "NO_IK_SOLUTION" in done.stdout
    assert "inverse kinematics:" not in done.stdout
    assert "Traceback" not in done.stdout + done.stderr


def test_a_goal_that_rolls_away_is_missed_in_the_core_too(core, tmp_path):
    file = tmp_path / "ball.scenario.yaml"
    file.write_text(
        "scenario: t\nrobot: open_manipulator_x\nobjects:\n"
        "  - {name: plate, static: true, box: {size: [0.5, 0.3, 0.02]},"
        " pose: {xyz: [0.2, -0.2, 0.03], rpy: [0, 0.05, 0]}}\n"
        "  - {name: ball, sphere: {radius: 2 cm}, mass: 0.05, pose: {xyz: [0.15, -0.2, 0.0625]}}\n"
        "steps: [{move_to: {position: {frame: ball, xyz: [0, 0, 0.1]}}}]\n"
    )
    done = core("run", file, "--no-report", "--in-process")
    assert done.returncode == 1
    assert "'ball', in whose frame the goal is, moved by itself" in " ".join(done.stdout.split())


def test_what_only_a_plug_in_can_do_is_refused_at_its_place(core, tmp_path):
    file = tmp_path / "formula.scenario.yaml"
    file.write_text(
        "robot: {model: open_manipulator_x}\nsteps: [{move_to: home}]\n"
        "expect: [{formula: 'always speed(tcp) < 2 m/s'}]\n"
    )
    done = core("check", file)
    assert done.returncode == 2
    assert "formula.scenario.yaml:3:" in done.stdout + done.stderr
    (tmp_path / "arm.xml").write_text("<mujoco/>")
    file.write_text("robot: {mjcf: arm.xml}\nsteps: [{wait: 1}]\n")
    done = core("check", file)
    assert done.returncode == 2
    assert "formula.scenario.yaml:1:15" in done.stdout + done.stderr
    assert "lacks the built-in plug-ins" in done.stdout + done.stderr
    file.write_text("robot: {urdf: arm.urdf}\nsteps: [{wait: 1}]\n")
    done = core("check", file)
    assert done.returncode == 2
    assert "formula.scenario.yaml:1:15" in done.stdout + done.stderr
    assert "no plug-in reads such a file" in done.stdout + done.stderr


@pytest.mark.nightly
def test_keys_and_grippers_of_a_plug_in_are_refused_at_their_place(core, tmp_path):
    file = tmp_path / "key.scenario.yaml"
    for key, value in (
        ("mount", "{pedestal: [0.2, 0.2, 0.5]}"),
        ("moveit", "{kinematics: k.yaml}"),
    ):
        file.write_text(
            f"scenario: t\nrobot: {{model: open_manipulator_x, {key}: {value}}}\n"
            "steps: [{wait: 1}]\n"
        )
        done = core("check", file)
        assert done.returncode == 2
        assert "key.scenario.yaml:2:4" in done.stdout + done.stderr
        assert "no plug-in applies this key here" in done.stdout + done.stderr
    arm = "{model: open_manipulator_x}"
    file.write_text(f"scenario: t\nrobots: {{a: {arm}, b: {arm}}}\nsteps: [{{wait: 1}}]\n")
    done = core("check", file)
    assert done.returncode == 2
    assert "key.scenario.yaml:2:9" in done.stdout + done.stderr
    assert "no plug-in applies this key here" in done.stdout + done.stderr
    file.write_text("scenario: t\nrobot: {model: suction_cup}\nsteps: [{gripper: on}]\n")
    done = core("check", file)
    assert done.returncode == 2
    assert "key.scenario.yaml:2:8" in done.stdout + done.stderr
    assert "no plug-in holds by `cups` here" in done.stdout + done.stderr
    file.write_text(
        "scenario: t\nrobot: {model: open_manipulator_x, base: {xyz: [0, 0, 1.02]}}\n"
        "world: lesson_ur\nsteps: [{pick: {object: green_cylinder, track: true}}]\n"
    )
    done = core("check", file)
    assert done.returncode == 2
    assert "key.scenario.yaml:4:48: no plug-in tracks belts here" in done.stdout + done.stderr
    file.write_text(
        "scenario: t\nrobot: open_manipulator_x\n"
        "steps: [{move_to: {named_target: home, path_constraints: {joints: {"
        "joint1: {position: 0, tolerance_above: 1, tolerance_below: 1}}}}}]\n"
    )
    done = core("check", file)
    assert done.returncode == 2
    assert "key.scenario.yaml:3:" in done.stdout + done.stderr
    assert "no plug-in applies this key here" in done.stdout + done.stderr
    (tmp_path / "box.obj").write_text(OBJ)
    file.write_text(
        "scenario: t\nrobot: open_manipulator_x\nsteps: [{wait: 1}]\n"
        "objects: [{name: box, mesh: {file: box.obj}, mass: 1, pose: {xyz: [1, 0, 1]}}]\n"
    )
    done = core("check", file)
    assert done.returncode == 2
    assert "key.scenario.yaml:4:11" in done.stdout + done.stderr
    assert "convex parts cannot be computed: no plug-in computes them" in done.stdout + done.stderr
    file.write_text(
        "scenario: t\nrobot: open_manipulator_x\nplanning: {planner_id: RRTstar}\n"
        "steps: [{move_to: home}]\n"
    )
    done = core("check", file)
    assert done.returncode == 2
    assert "key.scenario.yaml:3:" in done.stdout + done.stderr
    assert "there is no path finder 'ompl'" in done.stdout + done.stderr
    part = core("run", "lessons/04_gripper_alone", "--shard", "1/2", "--no-report")
    assert part.returncode == 2
    assert "--shard" in part.stderr
    bag = core("run", "lessons/04_gripper_alone", "--bag", "--no-report")
    assert bag.returncode == 2
    assert "there is no reporter 'rosbag'" in bag.stdout + bag.stderr
    nodes = core("run", "lessons/04_gripper_alone", "--node", "python student.py", "--no-report")
    assert nodes.returncode == 2
    assert "there is no case runner 'nodes'" in nodes.stdout + nodes.stderr
