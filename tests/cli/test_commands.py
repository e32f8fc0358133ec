import json
import subprocess
import sys
from pathlib import Path

import pytest

from harness import __version__
from harness.cli.main import main
from harness.spec.step import STEPS

HEAVY = (
    "pydantic",
    "numpy",
    "yaml",
    "mujoco",
    "pinocchio",
    "ompl",
    "toppra",
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
        ([], "COMMAND"),
        (["run"], "PATH"),
        (["run", "x", "--set", "robot"], "'robot' is not PATH=VALUE"),
        (["run", "x", "-j", "0"], "'0' is not a number from 1"),
        (["run", "x", "--hard-cap", "-1"], "'-1' is not a number of seconds above 0"),
        (["list", "robot"], "robots"),
        (["sweep", "x"], "invalid choice"),
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


def test_new_writes_a_file_and_never_over_another(folder, capsys):
    assert main(["new", "sub/first.scenario.yaml"]) == 0
    written = (folder / "sub/first.scenario.yaml").read_text()
    assert "harness run sub/first.scenario.yaml" in capsys.readouterr().out
    (folder / "mine.scenario.yaml").write_text("mine")
    assert main(["new", "mine.scenario.yaml"]) == 2
    assert "is there already" in capsys.readouterr().err
    assert (folder / "mine.scenario.yaml").read_text() == "mine"
    assert "\nsteps:\n" in written


def test_new_wants_the_name_that_folders_and_pytest_look_for(folder, capsys):
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
