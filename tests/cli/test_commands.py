import json
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from packaging.requirements import Requirement

from harness import __version__
from harness.cli.main import main
from harness.core.extras import install_command
from harness.core.registry import registry
from harness.core.spatial import xyzw_from_wxyz
from harness.language.step import STEPS
from harness.recording.read_run import read_run
from tests.running import run_case

HEAVY = (
    "pydantic",
    "numpy",
    "yaml",
    "mujoco",
    "pinocchio",
    "ompl",
    "cv2",
    "multiprocessing",
)


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def usage_error(arguments, capsys):
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2
    return capsys.readouterr().err


def test_help_imports_nothing_that_takes_time():
    code = (
        "import sys; from harness.cli.main import main\n"
        "try: main(['--help'])\nexcept SystemExit as end: assert end.code == 0\n"
        f"sys.exit(str([name for name in {HEAVY} if name in sys.modules] or ''))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stderr.strip() == ""
    assert done.stdout.startswith("usage: harness")


def test_the_version_is_the_packages(capsys):
    with pytest.raises(SystemExit) as caught:
        main(["--version"])
    assert caught.value.code == 0
    assert capsys.readouterr().out == f"armharness {__version__}\n"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["run"], "PATH"),
        (["run", "x", "--set", "robot"], "'robot' is not PATH=VALUE"),
        (["run", "x", "-j", "0"], "'0' is not a number from 1"),
        (["run", "x", "--hard-cap", "-1"], "'-1' is not a number of seconds above 0"),
        (["list", "robot"], "robots"),
        (["sweep", "x"], "is not valid"),
        (["test", "x"], "did you mean `run`?"),
        (["validate", "x"], "did you mean `check`?"),
        (["init"], "did you mean `new`?"),
        (["show", "x"], "did you mean `view`?"),
        (["version"], "did you mean `--version`?"),
        (["list", "steps2"], "did you mean `steps`?"),
        (["robot", "plan"], "valid words: check, show"),
        (["run", "x", "--out", "here"], "there is no option --out; did you mean --report-dir?"),
        (["check", "x", "--fromat=json"], "did you mean --format?"),
        (["robot", "check", "ur3e", "--wrold"], "`harness robot check --help` lists the options"),
        (["view", "run", "another"], "unexpected argument 'another'"),
    ],
)
def test_wrong_usage_is_exit_code_2_and_says_what_is_right(arguments, said, capsys):
    assert said in usage_error(arguments, capsys)


@pytest.mark.parametrize("command", ["run", "check", "explain"])
def test_a_path_that_is_not_there_is_exit_code_2(command, capsys):
    assert main([command, "nowhere.scenario.yaml"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("harness: no such file or folder: 'nowhere.scenario.yaml'")
    assert "Traceback" not in err


def test_k_that_selects_nothing_is_exit_code_2(capsys):
    assert main(["run", "lessons", "-k", "no_such_word"]) == 2
    assert "-k 'no_such_word' selects none of" in capsys.readouterr().err


def test_judging_a_folder_that_holds_no_run_is_exit_code_2(folder, capsys):
    assert main(["judge", str(folder)]) == 2
    assert "it has no run.json" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("kind", "line"),
    [
        ("robots", "ur3e"),
        ("robots", "open_manipulator_x"),
        ("robots", "rh_p12_rn_a"),
        ("worlds", "lesson_ur"),
        ("scenarios", "lessons/03_ur_sixteen_steps"),
        ("steps", "move_relative"),
        ("expectations", "never"),
        ("planners", "RRTConnect"),
    ],
)
def test_lists_name_what_a_scenario_may_name(kind, line, capsys):
    assert main(["list", kind]) == 0
    assert line in [row.split()[0] for row in capsys.readouterr().out.splitlines()]


def test_the_list_of_steps_has_every_verb_with_its_package(capsys):
    main(["list", "steps"])
    rows = [row.split(maxsplit=2) for row in capsys.readouterr().out.splitlines()]
    assert [verb for verb, _, _ in rows] == list(STEPS)
    assert {package for _, package, _ in rows} == {"armharness"}


def test_every_expectation_that_is_judged_is_listed_as_available(capsys):
    main(["list", "expectations"])
    rows = dict(row.split(maxsplit=1) for row in capsys.readouterr().out.splitlines())
    assert {"until", "formula", "always", "tcp_path"} <= set(rows)
    assert not [name for name, text in rows.items() if "not yet available" in text]


LINES = """\
scenario: Up and down
robot: ur3e
# a comment, which the resolved file does not have


steps:
  - ptp: {joints: {elbow_joint: -1, shoulder_lift_joint: -1.2}}
  - move_relative:   # written out differently
      {direction: {xyz: [0, 0, 1]}, distance: 3 cm}
    id: up
    expect:
      - tcp_path
  - wait: 0.1 s
    expect:

      - static
expect:
  - always: within_limits
  - tcp_path: {during: up}
"""


@pytest.fixture
def lines_run(folder):
    (folder / "lines.scenario.yaml").write_text(LINES)
    result = run_case(
        Path("lines.scenario.yaml"), report_dir=folder / "run", stills=False, page=False
    )
    assert result.outcome == "passed", result
    return folder / "run"


def test_judge_counts_the_lines_of_the_file_that_ran(lines_run, folder, capsys):
    assert main(["judge", str(lines_run)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [re.search(r"line (\d+):", line).group(1) for line in lines[:4]] == [
        "12", "16", "18", "19",
    ]  # fmt: skip
    other = LINES.replace("robot: ur3e\n", "robot: ur3e\n\n")
    (folder / "other.scenario.yaml").write_text(other)
    assert main(["judge", str(lines_run), "--with", "other.scenario.yaml"]) == 0
    assert "line 13: TCP path" in capsys.readouterr().out


def test_explain_prints_where_the_tcp_is_at_the_start_and_end_of_each_step(lines_run, capsys):
    assert main(["explain", "lines.scenario.yaml"]) == 0
    said = [
        (kind, np.array(xyz.split(","), float), np.array(quat.split(","), float))
        for kind, xyz, quat in re.findall(
            r"TCP (from|to|at) +\{xyz: \[(.*?)\], quat_xyzw: \[(.*?)\]\}",
            capsys.readouterr().out,
        )
    ]
    assert [kind for kind, _, _ in said] == ["from", "to", "from", "to", "at"]
    run = read_run(lines_run).run
    indices = [each for one in run.steps[:2] for each in (one.start_index, one.end_index - 1)]
    indices.append(run.steps[2].start_index)
    for (_, xyz, quat), index in zip(said, indices, strict=True):
        actual = run.signals.tcp_pose[index]
        np.testing.assert_allclose(xyz, actual[:3], atol=2e-4)
        np.testing.assert_allclose(abs(quat @ xyzw_from_wxyz(actual[3:])), 1.0, atol=1e-4)
    np.testing.assert_allclose(said[3][1] - said[2][1], [0, 0, 0.03], atol=2e-5)


def test_new_writes_a_file_and_never_over_another(folder, capsys):
    assert main(["new", "sub/first.scenario.yaml"]) == 0
    written = (folder / "sub/first.scenario.yaml").read_text()
    assert "harness run sub/first.scenario.yaml" in capsys.readouterr().out
    (folder / "mine.scenario.yaml").write_text("mine")
    assert main(["new", "mine.scenario.yaml"]) == 2
    assert "exists already" in capsys.readouterr().err
    assert (folder / "mine.scenario.yaml").read_text() == "mine"
    assert "\nsteps:\n" in written


def test_new_requires_the_name_that_folders_and_pytest_look_for(folder, capsys):
    assert main(["new", "first.yaml"]) == 2
    assert "try 'first.scenario.yaml'" in capsys.readouterr().err
    assert list(folder.iterdir()) == []


def test_the_schema_is_json_schema_and_the_same_when_written(folder, capsys):
    assert main(["schema"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert "json-schema.org" in printed["$schema"]
    assert {"scenario", "robot", "steps", "expect"} <= set(printed["properties"])
    assert main(["schema", "--write", "s.json"]) == 0
    assert json.loads((folder / "s.json").read_text()) == printed


@pytest.mark.nightly
def test_a_reader_that_leaves_early_gets_no_traceback():
    command = [sys.executable, "-u", "-m", "harness.cli", "list", "steps"]
    writer = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    writer.stdout.close()
    _out, err = writer.communicate()
    assert err == ""
    assert writer.returncode == 141


def test_the_command_is_the_module():
    done = subprocess.run(
        [Path(sys.executable).parent / "harness", "--version"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == f"armharness {__version__}\n"


@pytest.mark.nightly
@pytest.mark.parametrize("option", [("--yes",), ("--velocity-scaling", "0.5")])
def test_options_of_a_ros_2_robot_are_refused_without_one(option, capsys):
    assert main(["run", "lessons/04_gripper_alone", *option]) == 2
    assert "need --robot ros2" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["run", "bench", "search"])
@pytest.mark.parametrize("place", ["file", "file/below", "/proc/below"])
def test_a_place_that_takes_no_report_is_refused_before_anything_runs(
    command, place, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    (tmp_path / "a.scenario.yaml").write_text("this is no scenario")
    assert main([command, "a.scenario.yaml", "--report-dir", place]) == 2
    said = capsys.readouterr()
    assert f"--report-dir: nothing can be written into '{place}'" in said.err
    assert said.out == ""
    assert [each.name for each in tmp_path.iterdir()].count("file") == 1


def test_a_place_for_reports_does_not_matter_where_none_is_written(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "reports").write_text("a file")
    assert main(["run", "missing.scenario.yaml", "--no-report"]) == 2
    assert "--report-dir" not in capsys.readouterr().err


def test_the_command_alone_greets_with_commands_that_exist(capsys):
    assert main([]) == 0
    shown = re.findall(r"^  harness (\S+)", capsys.readouterr().out, re.MULTILINE)
    assert shown[-1] == "--help"
    assert set(shown[:-1]) <= set(registry("command"))


def test_a_list_without_a_kind_has_one_line_for_each_kind(capsys):
    from harness.cli.commands.list import LISTINGS

    assert main(["list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[2] for line in lines] == list(LISTINGS)
    assert main(["list", "worlds"]) == 0
    worlds = capsys.readouterr().out.split()
    [line] = [line for line in lines if "list worlds" in line]
    assert line.split()[3] == str(len(worlds))


@pytest.mark.parametrize("extra", ["studio", "parquet", "cluster"])
def test_the_command_that_installs_an_extra_names_its_packages(extra):
    """The distribution itself is on no index."""
    words = shlex.split(install_command(extra))
    assert words[:4] == [sys.executable, "-m", "pip", "install"]
    project = tomllib.loads(Path(__file__).parents[2].joinpath("pyproject.toml").read_text())
    stated = project["project"]["optional-dependencies"][extra]
    assert {str(Requirement(word)) for word in words[4:]} == {str(Requirement(s)) for s in stated}
