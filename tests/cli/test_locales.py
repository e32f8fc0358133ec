"""Commands in environments whose encoding is not UTF-8; files are UTF-8 all the same."""

import os
import shutil
import subprocess
import sys

import pytest

from tests.cli.run_in_terminal import HARNESS

SCENARIO = """\
scenario: Würfel über 漢字
robot: ur3e
objects:
  - name: würfel
    static: true
    box: {size: [5 cm, 5 cm, 5 cm]}
    pose: {xyz: [0.5, 0.3, 0.025]}
steps:
  - wait: 0.1 s
expect:
  - static: {object: würfel}
"""


@pytest.fixture(scope="module")
def latin_1(tmp_path_factory):
    """Environment variables of a German locale in ISO-8859-1."""
    if shutil.which("localedef") is None:
        pytest.skip("no localedef is installed")
    folder = tmp_path_factory.mktemp("locales")
    name = "de_DE.ISO-8859-1"
    done = subprocess.run(
        ["localedef", "-i", "de_DE", "-f", "ISO-8859-1", folder / name],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    if not (folder / name).is_dir():
        pytest.skip(f"no such locale can be made: {done.stderr}")
    return {"LOCPATH": str(folder), "LC_ALL": name}


@pytest.fixture(scope="module")
def ascii_only():
    return {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}


@pytest.fixture(params=["latin_1", "ascii_only"])
def environment(request):
    return {**os.environ, **request.getfixturevalue(request.param)}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "über.scenario.yaml").write_text(SCENARIO, encoding="utf-8")
    return tmp_path


@pytest.mark.nightly(but=["ascii_only-check"])
@pytest.mark.parametrize("verb", ["check", "run", "explain"])
def test_a_command_reads_utf_8_and_writes_what_the_terminal_has(folder, environment, verb):
    done = subprocess.run(
        [*HARNESS, verb, "über.scenario.yaml", *(["--no-page"] if verb == "run" else [])],
        cwd=folder, env=environment, capture_output=True, check=False,
    )  # fmt: skip
    encoding = "latin-1" if "LOCPATH" in environment else "ascii"
    said = done.stdout.decode(encoding) + done.stderr.decode(encoding)
    assert done.returncode == 0, said
    assert ("über" if encoding == "latin-1" else r"\xfcber") in said
    if verb != "check":
        assert r"\u6f22\u5b57" in said
    if verb == "run":
        assert (folder / "reports" / "über" / "run.json").is_file()


@pytest.mark.nightly
def test_a_bundled_arm_is_read_from_python_whatever_the_locale(folder, environment):
    code = "import harness; print(harness.run('plain.scenario.yaml').passed)"
    plain = "scenario: Plain\nrobot: ur5e\nsteps: [{wait: 0.1 s}]\nexpect: [tracking_error: 1]\n"
    (folder / "plain.scenario.yaml").write_text(plain)
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, env=environment,
        capture_output=True, text=True, errors="replace", check=False,
    )  # fmt: skip
    assert done.stdout == "True\n", done.stdout + done.stderr
