"""Packages that only some commands need, where they are not installed."""

import re
import struct
import subprocess
import sys
import tomllib
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from packaging.requirements import Requirement
from scipy.spatial import ConvexHull

from docs import ROOT
from harness.core.error_text import error_text
from harness.core.extras import EXTRAS, missing_extra

BLOCKED = """\
import sys
from importlib.abc import MetaPathFinder

class Absent(MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {packages!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, Absent())
import importlib.util
found = importlib.util.find_spec
importlib.util.find_spec = lambda name, package=None: (
    None if name.partition(".")[0] in {packages!r} else found(name, package)
)
from harness.cli.main import main
sys.exit(main())
"""


def without(packages, folder, *arguments):
    """Run a command in a Python that finds none of some packages."""
    command = [sys.executable, "-c", BLOCKED.format(packages={*packages}), *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def test_the_first_commands_need_no_package_of_an_extra(tmp_path):
    scenario = tmp_path / "a.scenario.yaml"
    scenario.write_text(
        "scenario: A\nrobot: {model: open_manipulator_x}\nworld: empty\nsteps: [{wait: 0.1 s}]\n"
        "expect: [{always: within_limits}]\n"
    )
    done = without(EXTRAS, tmp_path, "run", "a.scenario.yaml", "--in-process")
    assert done.returncode == 0, done.stdout + done.stderr
    assert (tmp_path / "reports/a/report.html").is_file()


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(
    ("package", "arguments"),
    [
        ("hypothesis", ["ik-test", "numeric", "--robot", "open_manipulator_x"]),
        ("cmaes", ["search", "variation/pick_where_it_stands"]),
        ("rosbags", ["run", "lessons/04_gripper_alone", "--bag"]),
        ("rosbags", ["run", "lessons/04_gripper_alone", "--reporter", "rosbag"]),
        ("av", ["run", "lessons/04_gripper_alone", "--film"]),
        ("zstandard", ["grade", "lessons/04_gripper_alone", "a.bag"]),
        ("lz4", ["grade", "lessons/04_gripper_alone", "a.bag"]),
    ],
)
def test_a_command_without_its_package_says_how_to_install_it(package, arguments, tmp_path):
    (tmp_path / "a.bag").touch()
    done = without([package], tmp_path, *arguments)
    assert done.returncode == 2, done.stderr
    [line] = done.stderr.splitlines()
    assert line.startswith(
        f"harness: the Python package {package} is not installed; install it by:"
    )
    assert f"{sys.executable} -m pip install" in line
    assert not (tmp_path / "reports").exists()


def test_a_video_without_its_package_is_refused_at_its_line(tmp_path):
    done = without(["av"], tmp_path, "run", "cameras/01_gripper_camera", "--in-process")
    assert done.returncode == 2
    assert "cameras/01_gripper_camera.scenario.yaml:" in done.stdout
    assert "the Python package av, which films, is not installed" in done.stdout
    assert "pip install" in done.stdout


SEEN = """\
scenario: A
robot: {model: open_manipulator_x}
world: empty
cameras: [{name: eye, pose: {xyz: [1, 0, 1]}, look_at: [0, 0, 0]}]
objects: [{name: card, OBJECT, static: true, pose: {xyz: [0.3, 0, 0]}}]
steps: [{capture: {camera: eye, kinds: [color, depth, segmentation]}}]
expect: [{sees: {camera: eye, WHAT}}]
"""
BOX, MARKER = "box: {size: [0.1, 0.1, 0.01]}", "marker: {id: 3, size: 0.1}"


@pytest.mark.nightly(but=["check-color"])
@pytest.mark.parametrize(
    ("thing", "what", "place"),
    [
        (MARKER, "object: card", "5:11: object 'card': its marker cannot be drawn"),
        (f"shapes: [{{{MARKER}}}]", "object: card", "5:11: object 'card': its marker cannot"),
        (BOX, "color: red", "7:38: pictures cannot be searched for it"),
        (BOX, "marker: 3", "7:39: pictures cannot be searched for it"),
    ],
    ids=["marked", "shape", "color", "marker"],
)
@pytest.mark.parametrize("command", [["check"], ["run", "--in-process"]], ids=["check", "run"])
def test_what_opencv_draws_or_finds_is_refused_at_its_line(command, thing, what, place, tmp_path):
    text = SEEN.replace("OBJECT", thing).replace("WHAT", what)
    (tmp_path / "a.scenario.yaml").write_text(text)
    done = without(["cv2"], tmp_path, *command, "a.scenario.yaml")
    assert done.returncode == 2, done.stdout + done.stderr
    said = " ".join(done.stdout.split())
    assert f"a.scenario.yaml:{place}" in said
    assert "the Python package cv2 is not installed; install it by:" in said
    assert not (tmp_path / "reports").exists()


@pytest.mark.nightly
def test_a_camera_looks_for_objects_without_opencv(tmp_path):
    text = SEEN.replace("OBJECT", BOX).replace("WHAT", "object: card")
    (tmp_path / "a.scenario.yaml").write_text(text)
    done = without(["cv2"], tmp_path, "run", "a.scenario.yaml", "--in-process", "--bag")
    assert done.returncode == 0, done.stdout + done.stderr
    pictures = {
        file.name.split(".", 2)[2] for file in (tmp_path / "reports/a/cameras/eye").iterdir()
    }
    assert pictures == {"color.png", "depth.npz", "depth.png", "labels.png", "segmentation.png"}


@pytest.mark.nightly
def test_the_film_of_a_saved_run_without_its_package_is_refused(tmp_path, recorded_run):
    scenario = tmp_path / "wait.scenario.yaml"
    scenario.write_text("scenario: A\nrobot: open_manipulator_x\nsteps: [{wait: 0.1 s}]\n")
    done = without(["av"], tmp_path, "film", recorded_run(scenario) / "run")
    assert done.returncode == 2
    assert done.stderr.startswith("harness: the Python package av is not installed; install it by:")


CORNERS = np.array([*product((0, 0.04), repeat=3)], np.float32)
FACES = ConvexHull(CORNERS).simplices
OBJECT = """\
scenario: A
robot: {model: open_manipulator_x}
world: empty
objects: [{name: part, mesh: {file: part.stl}, mass: 0.1, pose: {xyz: [0.3, 0, 0]}}]
steps: [{wait: 0.1 s}]
expect: [{always: within_limits}]
"""
ARM = """\
<robot name="arm"><link name="base"/>
<link name="tip"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><mesh filename="part.stl"/></geometry></collision></link>
<joint name="j" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>
"""
OF_ARM = OBJECT.replace("{model: open_manipulator_x}", "{urdf: arm.urdf}").replace(
    "objects: [{name: part, mesh: {file: part.stl}, mass: 0.1, pose: {xyz: [0.3, 0, 0]}}]\n", ""
)


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("text", "place"),
    [(OBJECT, "a.scenario.yaml:4:11: object 'part'"), (OF_ARM, "arm.urdf:4:38: link 'tip'")],
    ids=["object", "arm"],
)
@pytest.mark.parametrize(
    ("package", "fails"),
    [("trimesh", "part.stl cannot be read"), ("scipy", "convex parts cannot be computed")],
    ids=["trimesh", "scipy"],
)
def test_a_mesh_without_what_reads_it_is_refused_at_its_line(
    text, place, package, fails, tmp_path, monkeypatch
):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    facets = b"".join(struct.pack("<12fH", *[0] * 3, *CORNERS[f].ravel(), 0) for f in FACES)
    (tmp_path / "part.stl").write_bytes(bytes(80) + struct.pack("<I", len(FACES)) + facets)
    (tmp_path / "arm.urdf").write_text(ARM)
    (tmp_path / "a.scenario.yaml").write_text(text)
    done = without([package], tmp_path, "run", "a.scenario.yaml", "--in-process")
    assert done.returncode == 2, done.stdout + done.stderr
    said = " ".join(done.stdout.split())
    assert place in said
    assert f"{fails}: the Python package {package} is not" in said
    assert f"{sys.executable} -m pip install" in said


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("file", "package"), [("part.stl", "trimesh"), ("part.dae", "collada"), ("part.obj", "")]
)
def test_a_robot_is_drawn_without_the_meshes_that_nothing_reads(file, package, tmp_path):
    visual = f'<visual><geometry><mesh filename="{file}"/></geometry></visual><collision>'
    box = ARM.replace('<mesh filename="part.stl"/>', '<box size="0.1 0.1 0.1"/>')
    (tmp_path / "arm.urdf").write_text(box.replace("<collision>", visual, 1))
    (tmp_path / file).write_text("v 0 0 0")
    (tmp_path / "a.scenario.yaml").write_text(OF_ARM)
    done = without(["trimesh", "collada"], tmp_path, "check", "a.scenario.yaml")
    assert done.returncode == 0, done.stderr
    note = f"{file} cannot be read: the Python package {package} is not installed; install it by: "
    assert (note in done.stdout + done.stderr) == bool(package)


DISTRIBUTIONS = {
    "collada": "pycollada",
    "cv2": "opencv-python-headless",
}  # of packages that are called otherwise


def test_each_package_is_declared_in_its_extra_and_not_required():
    project = tomllib.loads(Path(ROOT, "pyproject.toml").read_text())["project"]
    required = {Requirement(each).name for each in project["dependencies"]}
    for package, extra in EXTRAS.items():
        stated = {Requirement(each).name for each in project["optional-dependencies"][extra]}
        assert DISTRIBUTIONS.get(package, package) in stated
        assert DISTRIBUTIONS.get(package, package) not in required


def test_an_import_of_anything_else_keeps_its_traceback():
    for name in ("no_such_module", "numpy.no_such_module", None):
        error = ModuleNotFoundError("No module", name=name)
        assert missing_extra(error) == ""
        assert "ModuleNotFoundError" in error_text(error)
    assert missing_extra(ImportError("x", name="av")) == ""


def test_no_page_and_no_message_installs_the_distribution_from_an_index():
    """It is on none: a clone, an address or a wheel is named instead."""
    pages = [
        *ROOT.glob("*.md"),
        *(ROOT / "docs").rglob("*.md"),
        *(ROOT / "scenarios").rglob("*.md"),
    ]
    templates = ROOT / "harness/plugins/authoring/templates"
    sources = [*(ROOT / "harness").rglob("*.py"), *templates.rglob("*.*")]
    for file in [*pages, *sources]:
        found = re.findall(r"pip install [^\n`]*?armharness\b(?! @)\S*", file.read_text("utf-8"))
        assert [each for each in found if "./armharness" not in each] == [], file
