"""Every long-running command of CONTRIBUTING.md works with the extras that its line names."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.installed import is_installed

ROOT = Path(__file__).resolve().parents[2]
COMMAND = re.compile(r"^python -m pytest -m (?P<marker>\w+)[^#]*#(?P<remark>.*)$", re.MULTILINE)


def _commands() -> dict[str, str]:
    """The extras of each marker's command, as pip reads them."""
    section = (ROOT / "CONTRIBUTING.md").read_text().split("## Long runs and timings")[1]
    found = {}
    for match in COMMAND.finditer(section.split("\n## ")[0]):
        extras = re.search(r"'\.\[([\w,-]+)\]'", match["remark"])
        found[match["marker"]] = extras[1] if extras else "test"
    return found


def test_there_is_a_command_for_every_marker_that_the_test_command_leaves_out(pytestconfig):
    left_out = set(re.findall(r"not (\w+)", " ".join(pytestconfig.getini("addopts"))))
    assert left_out
    assert left_out <= set(_commands())


def test_a_namespace_package_of_the_same_name_is_not_an_installed_distribution(tmp_path):
    (tmp_path / "only_a_namespace" / "models").mkdir(parents=True)
    code = (
        "from importlib.util import find_spec; from tests.installed import is_installed;"
        "assert find_spec('only_a_namespace'); assert not is_installed('only_a_namespace');"
        "assert is_installed('pytest')"
    )
    environment = {"PYTHONPATH": f"{tmp_path}:{ROOT}", "PATH": ""}
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env=environment, check=True)


@pytest.mark.parametrize("name", ["no-such-distribution", "harness", "tests"])
def test_an_importable_module_need_not_be_a_distribution(name):
    assert not is_installed(name)


@pytest.mark.readme
@pytest.mark.parametrize("extras", sorted(set(_commands().values())))
def test_a_command_collects_its_tests_with_the_extras_that_it_names(extras, tmp_path):
    clone = tmp_path / "clone"
    subprocess.run(["git", "clone", "--quiet", str(ROOT), str(clone)], check=True)
    subprocess.run([sys.executable, "-m", "venv", str(clone / ".venv")], check=True)
    python = str(clone / ".venv/bin/python")
    install = [python, "-m", "pip", "install", "--quiet", "-e", f".[{extras}]"]
    subprocess.run(install, cwd=clone, check=True)
    for marker in (name for name, needed in _commands().items() if needed == extras):
        collect = [python, "-m", "pytest", "--collect-only", "--quiet", "-m", marker]
        done = subprocess.run(collect, cwd=clone, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{marker}:\n{done.stdout[-3000:]}{done.stderr[-2000:]}"
