"""Names, folders and environments that suites rarely meet: exit code 2, or a result."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from harness.cli.main import main
from tests.running import exit_code

SCENARIO = "scenario: Wait\nrobot: open_manipulator_x\nsteps: [{wait: 2 ms}]\n"
LONG = "a" * 300


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.scenario.yaml").write_text(SCENARIO)
    return tmp_path


def harness(*words, **environment):
    return subprocess.run(
        [sys.executable, "-m", "harness.cli", *words], capture_output=True, text=True,
        check=False, env={**os.environ, **environment},
    )  # fmt: skip


@pytest.mark.parametrize(
    "words",
    [
        ("run", LONG),
        ("check", f"{LONG}/a.scenario.yaml"),
        ("run", "a.scenario.yaml", "--report-dir", LONG),
        ("run", "a.scenario.yaml", "--report-dir", f"reports/{LONG}"),
        ("run", "a.scenario.yaml", "--conditions", LONG),
        ("grade", "a.scenario.yaml", LONG),
        ("view", LONG),
        ("judge", LONG),
        ("film", LONG),
        ("compare", LONG, LONG),
        ("results", LONG),
        ("new", f"{LONG}.scenario.yaml"),
        ("new", "--project", LONG),
        ("import", "mjcf", LONG),
        ("course", "start", "3", LONG),
        ("mcp", "--root", LONG),
    ],
)
def test_a_name_that_is_too_long_is_wrong_usage(words, capsys):
    assert exit_code(*words) == 2
    said = capsys.readouterr().err
    assert LONG[:60] in said
    assert "Traceback" not in said


def test_a_folder_of_packages_whose_name_is_too_long_is_wrong_usage(capsys):
    with pytest.raises(SystemExit, match="2"):
        main(["run", "a.scenario.yaml", "--package-path", LONG])
    assert LONG in capsys.readouterr().err


@pytest.mark.parametrize("words", [("run",), ("view",), ("grade", "a.scenario.yaml")])
def test_a_link_that_leads_to_itself_is_wrong_usage(words, folder, capsys):
    (folder / "loop").symlink_to(folder / "loop")
    assert main([*words, "loop/b"]) == 2
    said = capsys.readouterr().err
    assert "loop" in said
    assert "Traceback" not in said


@pytest.mark.parametrize(
    ("keys", "line"),
    [
        (f"robot: {LONG}", 2),
        (f"robot: {{model: ./{LONG}}}", 2),
        (f"robot: {{urdf: {LONG}.urdf}}", 2),
        (f"robot: {{xacro: {LONG}/a.xacro}}", 2),
        (f"robot: {{model: ur5e, gripper: {LONG}}}", 2),
        (f"robot: ur5e\nworld: {LONG}.sdf", 3),
        (f"robot: ur5e\nworld: {LONG}", 3),
        (f"robot: ur5e\nobjects: [{{name: m, mesh: {{file: {LONG}.stl}}}}]", 3),
    ],
)
def test_a_name_in_a_file_that_is_too_long_is_a_mistake_at_its_place(keys, line, capsys):
    Path("a.scenario.yaml").write_text(SCENARIO.replace("robot: open_manipulator_x", keys))
    assert main(["check", "a.scenario.yaml"]) == 2
    assert f"a.scenario.yaml:{line}:" in capsys.readouterr().out


@pytest.mark.nightly
def test_reports_of_long_names_have_shorter_folders():
    names = ("b" * 240, "b" * 239 + "c")
    for name in names:
        grid = f"params: {{t: 2, u: 2}}\nparametrize: {{t: [{'é' * 200}1], u: [{'ü' * 200}]}}\n"
        Path(f"{name}.scenario.yaml").write_text(SCENARIO + grid)
    assert main(["run", *(f"{name}.scenario.yaml" for name in names), "--no-page"]) == 0
    cases = json.loads(Path("reports/results.json").read_text())["cases"]
    assert len({each["report_dir"] for each in cases}) == 2
    assert all(Path(each["report_dir"], "run.json").is_file() for each in cases)


def test_a_folder_that_cannot_be_listed_is_named(folder, capsys):
    """Its path has more bytes than the system takes."""
    for _ in range(20):
        Path("d" * 250).mkdir()
        os.chdir("d" * 250)
    os.chdir(folder)
    assert main(["run", str(folder)]) == 2
    assert "File name too long; name files or other folders" in capsys.readouterr().err


@pytest.mark.skipif(os.geteuid() == 0, reason="root lists every folder")
def test_a_folder_without_permission_is_named(folder, capsys):
    (folder / "closed").mkdir(mode=0)
    assert main(["run", str(folder)]) == 2
    assert "closed' cannot be found: Permission denied" in capsys.readouterr().err


def test_files_whose_names_are_not_utf8_are_refused(folder):
    for name in (b"caf\xe9.scenario.yaml", b"th\xe9.scenario.yaml"):
        Path(os.fsdecode(os.fsencode(folder) + b"/" + name)).write_text(SCENARIO)
    refused = harness("run", ".")
    assert refused.returncode == 2
    assert r"the name of b'caf\xe9.scenario.yaml' is not UTF-8" in refused.stderr
    assert not (folder / "reports").exists()


@pytest.mark.parametrize("words", [("run", "a.scenario.yaml"), ("check", "/"), ("list", "robots")])
def test_a_working_directory_that_was_deleted_is_named(folder, words):
    code = f"""if True:
        import os, sys
        os.mkdir("gone"); os.chdir("gone"); os.rmdir("../gone")
        from harness.cli.main import main
        sys.exit(main({list(words)}))
    """
    # -P: Python 3.13.0 cannot import `socket` where "" on sys.path names a deleted folder.
    command = [sys.executable, "-P", "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "the working directory cannot be used: No such file or directory" in done.stderr
    assert list(folder.iterdir()) == [folder / "a.scenario.yaml"]


@pytest.mark.nightly
def test_python_without_docstrings_gives_the_same_digest():
    found = [
        harness("run", "a.scenario.yaml", "--no-page", "--json", PYTHONOPTIMIZE=level)
        for level in ("", "2")
    ]
    assert [each.returncode for each in found] == [0, 0]
    first, second = (json.loads(each.stdout)["cases"][0]["digest"] for each in found)
    assert first == second


@pytest.mark.parametrize(
    ("keys", "line"),
    [
        ("robot: {urdf: ~no_such_user/arm.urdf}", 2),
        ("robot: {model: ur3e, packages: [~no_such_user]}", 2),
        ("robot: open_manipulator_x\nworld: ~no_such_user/world.yaml", 3),
        (
            "robot: open_manipulator_x\nobjects:\n  - {name: a, mesh: {file: ~no_such_user/a.obj},"
            " static: true, pose: {xyz: [1, 0, 0]}}",
            4,
        ),
    ],
)
def test_the_home_folder_of_no_user_is_a_mistake_at_its_place(keys, line, capsys, folder):
    del folder
    Path("home.scenario.yaml").write_text(f"scenario: x\n{keys}\nsteps: [{{wait: 10 ms}}]\n")
    assert main(["check", "home.scenario.yaml"]) == 2
    assert f"home.scenario.yaml:{line}:" in capsys.readouterr().out
