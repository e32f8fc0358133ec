"""The markers of long tests, and the extras that some of them need."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from tests.extras import PREFIX, distributions_of, extra_of, missing
from tests.installed import is_installed

ROOT = Path(__file__).resolve().parents[2]
OPTIONS = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["pytest"]["ini_options"]
MARKERS = [each.partition(":")[0] for each in OPTIONS["markers"]]
NEEDS = [marker for marker in MARKERS if marker.startswith(PREFIX)]


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


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize("marker", NEEDS)
def test_a_test_is_skipped_without_its_extra_and_is_never_part_of_the_default_run(marker, pytester):
    pytester.makepyprojecttoml(f"[tool.pytest.ini_options]\nmarkers = {MARKERS}")
    pytester.makepyfile(
        f"import pytest\n@pytest.mark.{marker}\ndef test_short(): pass\n"
        f"@pytest.mark.benchmark\n@pytest.mark.{marker}\ndef test_timing(): pass\n"
    )
    extra, plugin = extra_of(marker), ("-p", "tests.extras")
    assert list(distributions_of(extra))
    pytester.runpytest(*plugin, "-m", OPTIONS["addopts"][-1][3:]).assert_outcomes(deselected=2)
    nightly = pytester.runpytest(*plugin, "-m", "nightly", "-rs")
    if missing(extra):
        nightly.assert_outcomes(skipped=1, deselected=1)
        nightly.stdout.fnmatch_lines([f"*pip install -e '.?test,{extra}]'*"])
    else:
        nightly.assert_outcomes(passed=1, deselected=1)


@pytest.mark.nightly
@pytest.mark.parametrize("marker", ["nightly", "benchmark", *NEEDS])
def test_tests_are_collected_in_an_environment_with_only_their_extra(marker, tmp_path):
    clone = tmp_path / "clone"
    subprocess.run(["git", "clone", "--quiet", str(ROOT), str(clone)], check=True)
    subprocess.run([sys.executable, "-m", "venv", str(clone / ".venv")], check=True)
    python = str(clone / ".venv/bin/python")
    extras = f".[test,{extra_of(marker)}]" if marker in NEEDS else ".[test]"
    install = [python, "-m", "pip", "install", "--quiet", "-e", extras]
    subprocess.run(install, cwd=clone, check=True)
    collect = [python, "-m", "pytest", "--collect-only", "--quiet", "-m", marker]
    done = subprocess.run(collect, cwd=clone, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{marker}:\n{done.stdout[-3000:]}{done.stderr[-2000:]}"
