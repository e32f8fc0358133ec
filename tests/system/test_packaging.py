import json
import os
import subprocess
import sys
import sysconfig
import tomllib
import zipfile
from pathlib import Path

import pytest

from harness.planning.collision.native.sources import library_path

ROOT = Path(__file__).parents[2]
TEST_COMMAND = (
    "python3 -m venv .venv && .venv/bin/pip install -q -e '.[dev]' && "
    ".venv/bin/python -m pytest -n auto"
)
DEMO_COMMAND = (
    "python3 -m venv .venv && .venv/bin/pip install -q --no-compile . && "
    ".venv/bin/harness run scenarios/lessons/03_ur_sixteen_steps.scenario.yaml"
)


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "-o", str(folder), "."]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    [wheel] = folder.glob("*.whl")
    return wheel


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """A folder with the wheel's content, as pip would lay it out, outside of the checkout."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--no-index"]
    subprocess.run([*command, "--target", str(folder), str(wheel)], check=True, capture_output=True)
    return folder


@pytest.fixture
def harness(installed, tmp_path):
    """Runs the installed package's command from a folder that knows nothing of the checkout."""

    def run(*arguments):
        code = "import sys; from harness.cli.main import main; sys.exit(main())"
        return subprocess.run(
            [sys.executable, "-P", "-c", code, *arguments],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(installed)},
            capture_output=True,
            text=True,
            check=False,
        )

    return run


def names(done):
    assert done.returncode == 0, done.stderr
    return [line.split()[0] for line in done.stdout.splitlines()]


@pytest.mark.nightly
def test_the_wheel_holds_package_data_and_licence_and_nothing_else(wheel):
    inside = zipfile.ZipFile(wheel).namelist()
    tops = {name.split("/")[0] for name in inside}
    assert tops == {"harness", f"{wheel.name.split('-py3')[0]}.dist-info"}
    assert library_path().relative_to(ROOT).as_posix() in inside
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    assert wheel.name.endswith(f"-py3-none-{platform}.whl")
    assert any(name.endswith("licenses/LICENSE") for name in inside)
    assert {"harness/plugins/authoring/templates/new.scenario.yaml", "harness/py.typed"} <= set(
        inside
    )
    assert not [name for name in inside if "__pycache__" in name or "/reports/" in name]
    for kind in ("robots", "worlds", "scenarios"):
        ours = {
            file.relative_to(ROOT).as_posix()
            for file in (ROOT / kind).rglob("*")
            if file.is_file() and "__pycache__" not in file.parts
        }
        assert ours
        assert {f"harness/data/{name}" for name in ours} <= set(inside)


@pytest.mark.nightly
def test_an_installed_package_is_not_the_checkout(harness, installed):
    shown = harness("new", "a.scenario.yaml")
    assert shown.returncode == 0
    code = "import harness; print(harness.__file__)"
    env = {**os.environ, "PYTHONPATH": str(installed)}
    done = subprocess.run(
        [sys.executable, "-P", "-c", code], env=env, capture_output=True, text=True, check=True
    )
    assert Path(done.stdout.strip()).is_relative_to(installed)


@pytest.mark.nightly
def test_an_installed_package_finds_robots_worlds_and_scenarios(harness):
    robots = {"ur3e", "ur5e", "open_manipulator_x", "rh_p12_rn_a"}
    assert robots <= set(names(harness("list", "robots")))
    assert {"empty", "lesson_om", "lesson_ur"} <= set(names(harness("list", "worlds")))
    assert "lessons/03_ur_sixteen_steps" in names(harness("list", "scenarios"))


@pytest.mark.nightly
def test_an_installed_package_runs_a_bundled_lesson_by_its_name(harness, tmp_path):
    done = harness("run", "lessons/04_gripper_alone", "--json")
    document = json.loads(done.stdout)
    assert document["cases"][0]["outcome"] == "passed", done.stdout
    assert done.returncode == document["exit_code"] == 0
    assert (tmp_path / "reports/lessons/04_gripper_alone/run.json").is_file()


def test_the_readme_and_ci_have_the_same_test_command():
    readme = (ROOT / "README.md").read_text()
    assert TEST_COMMAND in readme
    assert DEMO_COMMAND in readme
    assert f'test_command="{TEST_COMMAND}"' in (ROOT / ".ci/run").read_text()


def test_what_the_commands_need_is_declared():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert project["scripts"] == {"harness": "harness.cli.main:entry"}
    assert project["entry-points"]["pytest11"] == {"armharness": "harness.pytest_plugin.plugin"}
    assert project["requires-python"] == ">=3.11,<3.14"
