"""An expectation of another package reaches every output, and cannot be used without the package.

The package is written as an installed wheel leaves it: its module, and a dist-info folder with the
entry point, in a folder on the path.
"""

import json
import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree as ET

import jsonschema
import pytest

from tests.core.test_registry import install

TCP_HEIGHT = '''
"""Heights of the TCP."""

from harness.expectations import Length, Margin, Predicate, Window


class TcpHeight(Predicate):
    """The TCP is at least this high above the world's origin."""

    at_least: Length

    def signal(self, window: Window) -> Margin:
        return window.tcp_position[:, 2] - self.at_least
'''
SCENARIO = """\
scenario: the TCP stays up
robot: open_manipulator_x
steps:
  - settle
expect:
  - tcp_height: {at_least: 5 cm}
  - always: {tcp_height: {at_least: 4 cm}}
"""
FAILING = SCENARIO.replace("5 cm", "5 m")


@pytest.fixture
def site(tmp_path):
    """A folder with the installed package `cell-checks`."""
    folder = tmp_path / "site"
    folder.mkdir()
    install(folder, "cell-checks", "cell_checks", TCP_HEIGHT)
    return folder


@pytest.fixture
def scenario(tmp_path):
    """A scenario that uses it."""
    path = tmp_path / "up.scenario.yaml"
    path.write_text(SCENARIO, encoding="utf-8")
    return path


def python(*arguments, site=None, cwd=None):
    """A Python process, with a folder more on its path."""
    paths = [str(Path(__file__).parents[3]), *([str(site)] if site else [])]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
    done = subprocess.run(
        [sys.executable, *map(str, arguments)],
        capture_output=True,
        text=True,
        env=environment,
        cwd=cwd,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


COMMANDS = """
import contextlib, io, json, sys
from harness.cli.main import main

answers = []
for command in json.loads(sys.argv[1]):
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = main(command)
        except SystemExit as ended:
            code = ended.code
    answers.append((code, out.getvalue(), err.getvalue()))
print(json.dumps(answers))
"""


def harness(*commands, **options):
    """Exit code and output of commands, one after the other in one new process."""
    words = [[str(word) for word in command] for command in commands]
    answers = json.loads(python("-c", COMMANDS, json.dumps(words), **options).splitlines()[-1])
    return [(code, out + err) for code, out, err in answers]


@pytest.mark.nightly
def test_it_is_checked_explained_listed_and_in_the_schema(site, scenario):
    (checked, explained, listed, schema) = harness(
        ("check", scenario),
        ("explain", scenario),
        ("list", "expectations"),
        ("schema",),
        site=site,
    )
    assert [code for code, _ in (checked, explained, listed, schema)] == [0, 0, 0, 0], checked
    assert "tcp_height, at least 50.0 mm" in explained[1]
    assert "always: tcp_height, at least 40.0 mm" in explained[1]
    (row,) = [line for line in listed[1].splitlines() if line.startswith("tcp_height ")]
    assert row.split()[1] == "cell-checks"
    assert row.endswith("The TCP is at least this high above the world's origin.")
    validator = jsonschema.Draft7Validator(json.loads(schema[1]))
    words = validator.schema["$defs"]["Predicate"]["anyOf"][0]["properties"]
    assert words["tcp_height"]["description"].startswith("The TCP is at least this high")
    valid = {
        "scenario": "x",
        "robot": "ur3e",
        "steps": ["settle"],
        "expect": [{"tcp_height": {"at_least": "5 cm"}}],
    }
    assert validator.is_valid(valid)
    assert not validator.is_valid({**valid, "expect": [{"tcp_height": {"at_leest": "5 cm"}}]})


@pytest.mark.nightly
def test_it_is_on_the_reference_page(site):
    code = (
        "from docs.generators.expectations import expectations_reference;"
        "print(expectations_reference())"
    )
    section = python("-c", code, site=site).split("\n## `tcp_height`\n")[1].split("\n## ")[0]
    assert "This expectation comes from the package `cell-checks`." in section
    assert "| `at_least` | a length [m] | required |" in section
    assert "| tcp height | m | at least `at_least` |" in section


@pytest.mark.nightly
def test_it_is_judged_reported_and_judged_again(site, scenario, tmp_path):
    failing = tmp_path / "failing.scenario.yaml"
    failing.write_text(FAILING, encoding="utf-8")
    folder = tmp_path / "reports"
    record = folder / "failing/run.json"
    run = ("run", scenario.name, failing.name, "--report-dir", folder, "--in-process")
    for code, said in harness(run, ("judge", record.parent), site=site, cwd=tmp_path):
        assert code == 1, said
        assert "tcp_height, at least 5.0 m" in said
    first, second = json.loads(record.read_text(encoding="utf-8"))["verdicts"]
    assert (first["status"], second["status"]) == ("failed", "passed")
    assert first["unit"] == "m"
    (measure,) = first["measures"]
    assert (measure["name"], measure["limit"]) == ("tcp height", 5.0)
    assert measure["value"] == pytest.approx(5.0 + first["margin"])
    assert "tcp height is" in first["reason"]
    assert "tcp_height, at least 5.0 m" in (record.parent / "report.html").read_text("utf-8")
    (junit,) = folder.rglob("junit.xml")
    assert "tcp height is" in " ".join(ET.parse(junit).getroot().itertext())
    ((code, said),) = harness(("judge", record.parent))
    assert code == 2
    assert "no predicate is called `tcp_height`" in said


@pytest.mark.nightly
def test_pytest_collects_it(site, scenario):
    options = ("-p", "no:cacheprovider", "-p", "no:xdist", "-q", scenario.name)
    assert "1 passed" in python("-m", "pytest", *options, site=site, cwd=scenario.parent)


@pytest.mark.nightly
def test_a_file_that_uses_it_without_the_package_is_refused_at_its_lines(scenario):
    commands = [(command, scenario) for command in ("check", "run", "explain")]
    for code, said in harness(*commands, cwd=scenario.parent):
        assert code == 2, said
        assert "no predicate is called `tcp_height`" in said
        assert "up.scenario.yaml:6:5" in said
        assert "up.scenario.yaml:7:14" in said


@pytest.mark.nightly
@pytest.mark.parametrize("form", ["module", "file"])
def test_one_module_is_loaded_with_an_option(tmp_path, scenario, form):
    (tmp_path / "heights.py").write_text(TCP_HEIGHT, encoding="utf-8")
    plugin = "heights" if form == "module" else tmp_path / "heights.py"
    commands = (("check", scenario), ("run", scenario, "--no-report"), ("list", "expectations"))
    answers = harness(*((*each, "--plugin", plugin) for each in commands), site=tmp_path)
    assert [code for code, _ in answers] == [0, 0, 0], answers
    (row,) = [line for line in answers[-1][1].splitlines() if line.startswith("tcp_height ")]
    assert row.split()[1] == "heights"
    scenario.write_text(FAILING, encoding="utf-8")
    run = ("run", scenario, "--no-report", "--plugin", plugin)
    ((code, said),) = harness(run, site=tmp_path)
    (again,) = [line for line in said.splitlines() if "again:" in line]
    assert code == 1
    assert again.endswith(f"--plugin {plugin}")


FORGETFUL = '''
from harness.judging.poses import link_poses
from harness.expectations import *


class ElbowHeight(Predicate):
    """The elbow is at least this high."""

    at_least: Length

    def signal(self, window):
        return window.cut(link_poses(window.run, "link3"))[:, 2] - self.at_least
'''
DECLARED = """
    def observations(self):
        return Observations(frozenset({"link3"}))
"""


@pytest.mark.nightly
def test_a_predicate_that_reads_what_it_does_not_declare_is_an_error_of_the_program(
    tmp_path, scenario
):
    scenario.write_text(SCENARIO.replace("tcp_height", "elbow_height"), encoding="utf-8")
    module = tmp_path / "elbow.py"
    module.write_text(FORGETFUL, encoding="utf-8")
    ((code, said),) = harness(("run", scenario, "--no-report", "--plugin", module))
    assert code == 3, said
    assert "ElbowHeight reads the pose of the link 'link3'" in said
    assert "`observations` does not declare" in said
    module.write_text(FORGETFUL + DECLARED, encoding="utf-8")
    ((code, said),) = harness(("run", scenario, "--no-report", "--plugin", module))
    assert code == 0, said


RAISING = """
from harness.expectations import Length, Predicate


class Odd(Predicate):
    \"\"\"A mistake.\"\"\"

    at_least: Length

    def signal(self, window):
        return {0}
"""


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("1.0", "Odd.signal returns an array of shape (), not one margin for each of"),
        ("window.tcp_position", "Odd.signal returns an array of shape ("),
        ("window.times[0] / 0 / [][0]", "Odd.signal raised IndexError"),
        ("None.size", "Odd.signal raised AttributeError: 'NoneType'"),
    ],
)
def test_a_signal_that_goes_wrong_is_an_error_of_the_program(tmp_path, scenario, body, expected):
    scenario.write_text(SCENARIO.replace("tcp_height", "odd"), encoding="utf-8")
    module = tmp_path / "odd.py"
    module.write_text(RAISING.format(body), encoding="utf-8")
    ((code, said),) = harness(("run", scenario, "--no-report", "--plugin", module))
    assert code == 3, said
    assert expected in said


WRONG = {
    "no_docstring": (
        "    at_least: Length\n    def signal(self, window): ...",
        "the expectation Wrong has no docstring",
    ),
    "no_signal": ("    at_least: Length", "the predicate Wrong has no method `signal`"),
    "no_quantity": (
        "    def signal(self, window): ...",
        "the predicate Wrong does not say what it measures",
    ),
    "no_bound": (
        "    tolerance: Length\n    def signal(self, window): ...",
        "give it `quantities`, or a bound `at_least` or `at_most` with a unit",
    ),
}


def test_a_class_that_forgets_something_is_refused_when_it_is_loaded(tmp_path, scenario):
    head = "from harness.expectations import Length, Predicate\n"
    for name, (body, _) in WRONG.items():
        docstring = "" if name == "no_docstring" else '    """A mistake."""\n'
        source = f"{head}class Wrong(Predicate):\n{docstring}{body}\n"
        (tmp_path / f"{name}.py").write_text(source)
    commands = [("check", scenario, "--plugin", tmp_path / f"{name}.py") for name in WRONG]
    for (code, said), (_, expected) in zip(harness(*commands), WRONG.values(), strict=True):
        assert code == 2, said
        assert expected in said
