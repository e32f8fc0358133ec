"""A step of another package is a step like every other, everywhere."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.plugins.commands import harness

SOURCE = Path(__file__).with_name("remarks.py").read_text(encoding="utf-8")
SCENARIO = """\
scenario: Remarks
robot: open_manipulator_x
world: lesson_om
steps:
  - remark: the arm stands where it starts
    expect:
      - duration: {at_most: 0.1 s}
  - repeat:
      times: 2
      steps:
        - remark: {text: again, about: red_box, pause: 40 ms}
  - parallel:
      - jog: {joint: joint1, by: 10 deg}
      - gripper: open
"""
UNKNOWN = "remarks.scenario.yaml:5:5: no verb is called `remark`"


@pytest.fixture(params=["installed", "module", "file"])
def plugged_in(request, tmp_path):
    """A folder with the scenario, and how a command gets the plug-in there."""
    (tmp_path / "remarks.scenario.yaml").write_text(SCENARIO, encoding="utf-8")
    library = tmp_path / "library"
    library.mkdir()
    (library / "remarks.py").write_text(SOURCE, encoding="utf-8")
    match request.param:
        case "installed":
            install(library)
            return tmp_path, library, "remarks-for-arms", []
        case "module":
            return tmp_path, library, "remarks", ["--plugin", "remarks"]
        case _:
            return tmp_path, library, "remarks", ["--plugin", "library/remarks.py"]


def install(library):
    """What pip leaves of a package with an entry point."""
    info = library / "remarks_for_arms-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: remarks-for-arms\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[harness.plugins]\nremarks = remarks\n")


def typed_result(run, library):
    """What the third step of a saved run reported, as the class of the plug-in gives it."""
    code = (
        "import sys; from pathlib import Path; from harness.core.registry import load_plugin;"
        "load_plugin('remarks'); import remarks; from harness.recording.read_run import read_run;"
        "print(read_run(Path(sys.argv[1])).run.steps[2].result.find(remarks.Remarked))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(run)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(library), *sys.path])},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.strip()


@pytest.mark.nightly
def test_every_output_has_the_steps_of_a_plug_in(plugged_in):
    folder, library, package, options = plugged_in

    def said(*arguments, code=0):
        return harness(folder, *arguments, *options, site=library, code=code)

    rows = [row.split(maxsplit=2) for row in said("list", "steps").splitlines()]
    assert ["remark", package, "Write a sentence about an object into the run's record."] in rows
    schema = json.loads(said("schema"))
    verbs = schema["$defs"]["Step"]["anyOf"][0]["properties"]
    assert verbs["remark"]["description"].startswith("Write a sentence")
    pause = schema["$defs"]["Remark"]["anyOf"][0]["properties"]["pause"]
    assert pause["description"] == "The step takes this long [s]. The unit is s (as text: s, ms)."
    explained = said("explain", "remarks.scenario.yaml")
    assert re.search(r"5  remark the arm stands where it starts  \[seed \d+\]", explained)
    assert "jog joint1 by 0.174533 rad" in explained
    wrong = {
        "words": SCENARIO.replace("about: red_box", "abuot: red_box").replace("40 ms", "4 m"),
        "names": SCENARIO.replace("red_box", "red_bax").replace("joint1", "joint9"),
    }
    for name, text in wrong.items():
        (folder / f"{name}.scenario.yaml").write_text(text)
    files = [f"{name}.scenario.yaml" for name in ("remarks", *wrong)]
    problems = said("check", *files, code=2)
    assert "remarks.scenario.yaml: ok\n" in problems
    assert "words.scenario.yaml:11:33: unknown key `abuot` in `remark`" in problems
    assert "`4 m` is a length; a time is expected" in problems
    assert "names.scenario.yaml:11:40: there is no object 'red_bax'" in problems
    assert "names.scenario.yaml:13:22: there is no joint 'joint9'" in problems


@pytest.mark.nightly
def test_a_run_of_a_plug_in_s_steps_is_recorded_and_reported(plugged_in):
    folder, library, _, options = plugged_in
    out = harness(folder, "run", "remarks.scenario.yaml", *options, site=library)
    assert "PASSED" in out.upper()
    (record,) = folder.glob("reports/**/run.json")
    steps = json.loads(record.read_text())["steps"]
    assert [step["step"] for step in steps] == [
        "remark the arm stands where it starts",
        "repeat 2 times",
        "remark again",
        "remark again",
        "parallel jog and gripper",
        "jog joint1 by 0.174533 rad",
        "gripper open",
    ]
    assert steps[2]["result"] == {"text": "again"}
    assert typed_result(record.parent, library) == "Remarked(text='again')"
    assert steps[2]["end_time"] - steps[2]["start_time"] == pytest.approx(0.04, abs=0.002)
    page = next(record.parent.glob("*.html")).read_text(encoding="utf-8")
    assert "remark the arm stands where it starts" in page


@pytest.mark.nightly
def test_the_reference_page_has_the_steps_of_a_plug_in(tmp_path):
    (tmp_path / "remarks.py").write_text(SOURCE, encoding="utf-8")
    install(tmp_path)
    code = "from docs.generators.reference import steps_reference; print(steps_reference())"
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])},
        capture_output=True,
        text=True,
        check=True,
    )
    section = done.stdout.split("## `remark`")[1].split("\n## ")[0]
    assert "This step comes from the package `remarks-for-arms`." in section
    assert "| `pause` | a time [s] | `0.02` | The step takes this long [s]. |" in section


@pytest.mark.nightly
def test_without_the_plug_in_the_verb_is_a_located_error(tmp_path):
    (tmp_path / "remarks.scenario.yaml").write_text(SCENARIO, encoding="utf-8")
    for command in (["check"], ["explain"], ["run", "--no-report"]):
        said = harness(tmp_path, *command, "remarks.scenario.yaml", code=2)
        assert UNKNOWN in said
        assert "    5 |   - remark: the arm stands where it starts" in said
        assert "remarks.scenario.yaml:13:9: no verb is called `jog`" in said
    assert not (tmp_path / "reports").exists()


def test_a_package_that_cannot_be_loaded_is_named_at_its_verb(tmp_path):
    (tmp_path / "remarks.scenario.yaml").write_text(SCENARIO, encoding="utf-8")
    (tmp_path / "remarks.py").write_text(f"import no_such_module\n{SOURCE}", encoding="utf-8")
    install(tmp_path)
    said = harness(tmp_path, "check", "remarks.scenario.yaml", site=tmp_path, code=2)
    assert UNKNOWN in said
    words = " ".join(re.sub(r"\n +\| ", " ", said).split())
    assert (
        "the plug-ins of the package `remarks-for-arms` cannot be loaded: ModuleNotFoundError: No"
        " module named 'no_such_module'"
    ) in words


@pytest.mark.nightly(but=[2, 1])
@pytest.mark.parametrize(
    ("module", "text", "reason"),
    [
        ("no_such_module", "", "ModuleNotFoundError: No module named 'no_such_module'"),
        ("none.py", None, "FileNotFoundError"),
        ("taken.py", SOURCE.replace('"remark"', '"pick"'), "two packages provide the step `pick`"),
        ("key.py", SOURCE.replace('"remark"', '"expect"'), "`expect` cannot be a step's verb"),
        (
            "mute.py",
            SOURCE.replace("    def execute", "    def do_nothing"),
            "the step `remark` needs an `execute` method",
        ),
        (
            "bare.py",
            SOURCE.replace('"""Write a sentence about an object into the run\'s record."""', ""),
            "the step `remark` has no docstring",
        ),
    ],
)
def test_a_plug_in_that_cannot_be_used_is_refused_with_its_reason(tmp_path, module, text, reason):
    if text:
        (tmp_path / module).write_text(text, encoding="utf-8")
    said = harness(tmp_path, "list", "steps", "--plugin", module, code=2)
    assert said.startswith("harness: plug-in ")
    assert reason in said


@pytest.mark.nightly
def test_a_scenario_cannot_name_a_module(tmp_path):
    (tmp_path / "remarks.py").write_text(SOURCE, encoding="utf-8")
    for key in ("plugin: remarks", "plugins: [remarks]", "HARNESS_PLUGINS: remarks"):
        text = SCENARIO.replace("robot:", f"{key}\nrobot:")
        (tmp_path / "remarks.scenario.yaml").write_text(text, encoding="utf-8")
        said = harness(tmp_path, "check", "remarks.scenario.yaml", site=tmp_path, code=2)
        assert f"unknown key `{key.partition(':')[0]}`" in said


@pytest.mark.nightly
@pytest.mark.parametrize("given", ["option", "ini"])
def test_pytest_collects_and_runs_a_scenario_with_a_plug_in(tmp_path, given):
    (tmp_path / "remarks.scenario.yaml").write_text(SCENARIO, encoding="utf-8")
    (tmp_path / "remarks.py").write_text(SOURCE, encoding="utf-8")
    ini = "harness_plugins = remarks.py\n" if given == "ini" else ""
    (tmp_path / "pytest.ini").write_text(f"[pytest]\n{ini}", encoding="utf-8")
    options = ["--harness-plugin", "remarks.py"] if given == "option" else []

    def pytest_says(*arguments):
        done = subprocess.run(
            [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-q", "--harness-no-report",
             *arguments],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
            capture_output=True,
            text=True,
            check=False,
        )  # fmt: skip
        return done.returncode, done.stdout

    code, out = pytest_says(*options)
    assert (code, "1 passed" in out) == (0, True), out
    if given == "option":
        code, out = pytest_says()
        assert code == 1
        assert "no verb is called `remark`" in out
