"""The example package is built, installed without a network, and each of its plug-ins is used."""

import json
import subprocess
import sys

import pytest

from tests.plugins.commands import EXAMPLE, harness

SCENARIO = """\
scenario: everything of a package
robot: {model: ur3e, ik_solver: newton, joint_controller: computed_torque}
world: boxes.csv
planning: {pipeline: via_point}
steps:
  - move_to: {pose: {xyz: [0.3, 0.1, 0.3], rpy: [180 deg, 0, 0]}}
  - wave: 10 deg
expect:
  - tcp_height: {at_least: 5 cm}
"""
GANTRY = """\
scenario: a robot of a package
robot: gantry
steps:
  - move_to: {joints: {slide_x: 0.2, slide_y: -0.1, slide_z: -0.2}}
"""
KINDS = {
    "steps": "wave",
    "expectations": "tcp_height",
    "pipelines": "via_point",
    "ik-solvers": "newton",
    "controllers": "computed_torque",
    "world-formats": "boxes_csv",
    "reporters": "verdict_table",
    "robots": "gantry",
    "commands": "tightest",
}


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The folder in which pip installs the package, built from a copy of its files."""
    folder = tmp_path_factory.mktemp("site")
    subprocess.run(
        [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation",
         "--no-index", "--disable-pip-version-check", "--root-user-action", "ignore",
         "--target", str(folder), str(EXAMPLE)],
        check=True,
        capture_output=True,
    )  # fmt: skip
    return folder


def test_every_plug_in_of_the_package_is_used_in_one_run(site, tmp_path):
    (tmp_path / "all.scenario.yaml").write_text(SCENARIO, encoding="utf-8")
    (tmp_path / "boxes.csv").write_text("crate,0.6,0.6,0.1,0.2,0.2,0.2\n", encoding="utf-8")
    words = ("all.scenario.yaml", "--reporter", "verdict_table", "--no-page")
    harness(tmp_path, "run", *words, site=site)
    (file,) = tmp_path.glob("reports/**/run.json")
    run = json.loads(file.read_text(encoding="utf-8"))
    move, wave = run["steps"]
    assert move["explanation"]["ik_method"] == "newton"
    assert wave["step"] == "wave by 0.174533 rad"
    assert "crate" in [each["name"] for each in run["objects"]]
    assert run["verdicts"][0]["status"] == "passed"
    rows = (file.parent / "verdicts.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0].startswith("passed,0.")
    printed = harness(tmp_path, "tightest", file.parent, site=site)
    assert printed.endswith("m  tcp_height, at least 50.0 mm (passed)\n")


@pytest.mark.nightly
def test_a_robot_of_the_package_moves(site, tmp_path):
    (tmp_path / "gantry.scenario.yaml").write_text(GANTRY, encoding="utf-8")
    assert "passed" in harness(tmp_path, "run", "gantry.scenario.yaml", "--no-report", site=site)
    out = harness(tmp_path, "check", "gantry.scenario.yaml", code=2)
    assert "gantry.scenario.yaml:2" in out
    assert "robot.model: 'gantry' is not known" in out


@pytest.mark.nightly
@pytest.mark.parametrize("kind", KINDS)
def test_the_lists_name_the_package(site, tmp_path, kind):
    rows = [row.split() for row in harness(tmp_path, "list", kind, site=site).splitlines()]
    (row,) = [row for row in rows if row[0] == KINDS[kind]]
    assert "example-arm-plugins" in row[1:3]


@pytest.mark.nightly
def test_without_the_package_every_name_is_a_located_error(tmp_path):
    (tmp_path / "all.scenario.yaml").write_text(SCENARIO, encoding="utf-8")
    out = harness(tmp_path, "check", "all.scenario.yaml", code=2)
    for problem in (
        "2:33: there is no inverse kinematics solver `newton`",
        "3:8: no world is called `boxes.csv`",
        "4:22: there is no planning pipeline `via_point`",
        "7:5: no verb is called `wave`",
        "9:5: no predicate is called `tcp_height`",
    ):
        assert f"all.scenario.yaml:{problem}" in out
    words = " ".join(out.replace("|", "").split())
    for kind in ("an inverse kinematics solver", "a world format", "a planning pipeline",
                 "a verb", "a predicate"):  # fmt: skip
        assert f"{kind} of a plug-in that is not installed needs `--plugin`" in words
    out = harness(tmp_path, "run", "all.scenario.yaml", "--reporter", "verdict_table", code=2)
    words = " ".join(out.split())
    assert (
        "--reporter: there is no reporter 'verdict_table'; known: film, green, html, rosbag"
        in words
    )
    assert "a reporter of a plug-in that is not installed needs `--plugin`" in words


@pytest.mark.nightly
def test_a_world_format_and_a_reporter_that_go_wrong_are_named(site, tmp_path):
    (tmp_path / "boxes.csv").write_text("crate,0.6,high\n", encoding="utf-8")
    (tmp_path / "bad.py").write_text(BAD, encoding="utf-8")
    text = GANTRY.replace("steps:", "world: boxes.csv\nsteps:")
    (tmp_path / "bad.scenario.yaml").write_text(text, encoding="utf-8")
    out = harness(tmp_path, "check", "bad.scenario.yaml", site=site, code=2)
    assert (
        "bad.scenario.yaml:3:8: the world format `boxes_csv` of the package `example-arm-p" in out
    )
    assert "raised ValueError: could not convert string to float: 'high'" in " ".join(out.split())
    (tmp_path / "bad.scenario.yaml").write_text(GANTRY, encoding="utf-8")
    out = harness(
        tmp_path, "run", "bad.scenario.yaml", "--reporter", "bad", "--plugin", "bad.py",
        site=site, code=3,
    )  # fmt: skip
    assert "the reporter `bad` of the package `bad` raised ZeroDivisionError" in out
    assert not list(tmp_path.glob("reports/**/run.json"))


BAD = '''
from harness.reporting.reporter import Reporter


class Bad(Reporter):
    """A reporter that fails."""

    name = "bad"

    def write(self, folder, stored):
        1 / 0
'''
