"""What a result follows from, so that a run that goes on computes what changed."""

import json
import os
import shutil
import sys
from pathlib import Path

import pytest

from harness.core.registry import load_plugin
from harness.core.resources import data_folder
from harness.reporting.result import CaseResult
from harness.session.run_request import RunRequest
from harness.suite.stream import FILE, Stream, fingerprint, is_intact
from tests.commands import forked, harness


@pytest.fixture
def job(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return RunRequest(Path("one.scenario.yaml"))


def passed(job):
    return CaseResult(str(job.file), job.case, "t", "passed")


def test_a_line_that_was_cut_off_leaves_the_others_whole(job, tmp_path):
    """A process that was killed while it wrote leaves half a line."""
    one, two = job, RunRequest(Path("two.scenario.yaml"))
    stream = Stream(tmp_path)
    for each in (one, two):
        stream.write(each, passed(each))
    stream.close()
    stream.path.write_bytes(stream.path.read_bytes()[:-40])
    again = Stream(tmp_path, resume=True)
    assert again.known(one) is not None
    assert again.known(two) is None
    again.write(two, CaseResult(str(two.file), "", "t", "failed"))
    again.close()
    place, head = Stream(tmp_path, resume=True).known(two)
    assert head.outcome == "failed"
    assert stream.path.read_bytes()[place.offset :].startswith(b'{"format"')
    lines = stream.path.read_bytes().splitlines(keepends=True)
    assert all(is_intact(line) or not line.strip() for line in lines)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (b'"passed"', b'"failed"'),
        (b'"digest":""', b'"digest":"0"'),
        (b'"title":"t"', b'"title": "t"'),
        (b"armharness-stream/3", b"armharness-stream/2"),
        (b',"check":', b',"other":'),
    ],
)
def test_a_case_whose_line_was_edited_is_run_again(job, tmp_path, before, after):
    stream = Stream(tmp_path)
    stream.write(job, passed(job))
    stream.close()
    text = stream.path.read_bytes()
    assert before in text
    stream.path.write_bytes(text.replace(before, after))
    assert Stream(tmp_path, resume=True).known(job) is None


@pytest.mark.parametrize("outcome", ["invalid", "error"])
def test_a_case_without_a_result_is_run_again(job, tmp_path, outcome):
    Stream(tmp_path).write(job, CaseResult(str(job.file), "", "t", outcome))
    assert Stream(tmp_path, resume=True).known(job) is None


def test_values_options_and_search_folders_count(job, monkeypatch):
    found = {fingerprint(job)}
    found.add(fingerprint(RunRequest(job.file, {"robot.model": "ur5e"})))
    found.add(fingerprint(RunRequest(job.file, seed=3)))
    found.add(fingerprint(RunRequest(job.file, case="a")))
    found.add(fingerprint(RunRequest(job.file, strict=True)))
    for name in ("GZ_SIM_RESOURCE_PATH", "HARNESS_PACKAGE_PATH", "HARNESS_PLUGINS"):
        monkeypatch.setenv(name, "folder")
        found.add(fingerprint(job))
    assert len(found) == 8


SCENARIO = """\
scenario: Everything from files
robot: {model: ./arm}
world: room.yaml
objects: [{name: part, mesh: {file: part.obj}, pose: {xyz: [0.25, 0, 0.05]}, static: true}]
steps:
  - include: {file: pause.steps.yaml}
  - nod: {}
params: {n: 1}
parametrize: {n: [1, 2]}
"""
PLUGIN = """\
from typing import ClassVar

from harness.cell.step import Step
from nodding import TIME


class Nod(Step):
    \"\"\"Wait for a time that another module states.\"\"\"

    verb: ClassVar[str] = "nod"

    def summary(self) -> str:
        return "nod"

    def execute(self, cell) -> None:
        assert TIME
"""
TETRAHEDRON = "v 0 0 0\nv 0.02 0 0\nv 0 0.02 0\nv 0 0 0.02\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """A folder with a run of a scenario that reads files of every kind."""
    folder = tmp_path_factory.mktemp("project")
    shutil.copytree(data_folder("robots") / "open_manipulator_x", folder / "arm")
    (folder / "a.scenario.yaml").write_text(SCENARIO)
    (folder / "room.yaml").write_text("world: Room\n")
    (folder / "part.obj").write_text(TETRAHEDRON)
    (folder / "pause.steps.yaml").write_text("steps: [{wait: 0.01}]\n")
    (folder / "nod.py").write_text(PLUGIN)
    (folder / "nodding.py").write_text("TIME = 1\n")
    assert "2 passed" in ran(folder)
    return folder


def ran(folder, *more):
    words = ["a.scenario.yaml", "--no-page", "--in-process", "--plugin", "nod.py", *more]
    done = harness("run", *words, cwd=folder)
    return done.stdout + done.stderr


def test_a_result_of_the_same_files_is_kept(project):
    assert "2 of them were known from before" in ran(project, "--resume")


@pytest.mark.nightly(but=["part.obj-# edited\\n"])
@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("arm/open_manipulator_x.urdf", "<!-- edited -->\n"),
        ("arm/open_manipulator_x.srdf", "<!-- edited -->\n"),
        ("arm/robot.yaml", "# edited\n"),
        ("room.yaml", "# edited\n"),
        ("part.obj", "# edited\n"),
        ("pause.steps.yaml", "# edited\n"),
        ("a.scenario.yaml", "# edited\n"),
        ("nod.py", "# edited\n"),
        ("nodding.py", "# edited\n"),
    ],
)
def test_a_changed_file_is_noticed(project, tmp_path, name, text):
    lines = (project / "reports" / FILE).read_text().splitlines()
    listed = [line for line in map(json.loads, lines) if "files" in line]
    assert name in {path for line in listed for path in line["files"]}
    copy = tmp_path / "copy"
    shutil.copytree(project, copy)
    with (copy / name).open("a") as file:
        file.write(text)
    assert not is_known(copy)


def searched(tmp_path, scenario, appears, text):
    """Whether a file that appears on a search path is noticed; the run uses a later folder."""
    for folder in ("first", "second"):
        (tmp_path / folder).mkdir()
    shutil.copytree(data_folder("robots") / "open_manipulator_x", tmp_path / "second" / "arm")
    (tmp_path / "second" / "arm" / "package.xml").write_text("<package><name>arm</name></package>")
    (tmp_path / "second" / "block").mkdir()
    (tmp_path / "second" / "block" / "model.sdf").write_text(MODEL)
    (tmp_path / "room.sdf").write_text(ROOM)
    (tmp_path / "arm.xacro").write_text(ARM)
    (tmp_path / "a.scenario.yaml").write_text(
        f"{scenario}params: {{n: 1}}\nparametrize: {{n: [1, 2]}}\n"
    )
    for plugin in ("nod.py", "nodding.py"):
        (tmp_path / plugin).write_text("TIME = 1\n")
    assert "2 passed" in ran(tmp_path)
    assert is_known(tmp_path)
    file = tmp_path / "first" / appears
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)
    return not is_known(tmp_path)


MODEL = """\
<sdf version="1.8"><model name="block"><static>true</static><link name="link">
<collision name="c"><geometry><box><size>0.1 0.1 0.1</size></box></geometry></collision>
</link></model></sdf>
"""
ROOM = """\
<sdf version="1.8"><world name="room"><include><uri>model://block</uri>
<pose>1 0 0.05 0 0 0</pose></include></world></sdf>
"""
FOUND_LATE = """\
scenario: Found in the second folder
robot:
  urdf: package://arm/open_manipulator_x.urdf
  srdf: package://arm/open_manipulator_x.srdf
  packages: [first, second]
steps: [{wait: 0.01}]
"""
MODELS = """\
scenario: Found in the second folder
robot: {model: open_manipulator_x}
world: {name: room.sdf, model_path: [first, second]}
steps: [{wait: 0.01}]
"""


OPTIONAL = """\
scenario: Files that a robot may have
robot: {xacro: arm.xacro}
steps: [{wait: 0.01}]
"""
PROPERTY = '<robot xmlns:xacro="x"><xacro:property name="width" value="0.3"/></robot>'
ARM = """\
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:property name="width" value="0.1"/>
<xacro:include filename="first/own.xacro" optional="true"/>
<xacro:include filename="first/part*.xacro"/>
<link name="base"/><link name="tip"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="${width} 0.1 0.1"/></geometry></collision></link>
<joint name="turn" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/>
<origin xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="9"/></joint></robot>
"""


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("scenario", "appears", "text"),
    [
        (FOUND_LATE, "package.xml", "<package><name>arm</name></package>"),
        (FOUND_LATE, "arm/package.xml", "<package><name>arm</name></package>"),
        (MODELS, "block/model.sdf", MODEL),
        (OPTIONAL, "own.xacro", PROPERTY),
        (OPTIONAL, "part_b.xacro", PROPERTY),
    ],
    ids=["a package", "a folder of packages", "a model", "an optional include", "a wildcard"],
)
def test_what_appears_earlier_on_a_search_path_is_noticed(tmp_path, scenario, appears, text):
    assert searched(tmp_path, scenario, appears, text)


FUEL = "fuel/fuel.gazebosim.org/maker/models/shelf"
GZ_ROBOT = """\
<sdf version="1.9"><model name="arm"><include merge="true"><uri>model://limb</uri></include>
<link name="base"/><joint name="turn" type="revolute"><parent>base</parent><child>limb</child>
<axis><limit><lower>-1</lower><upper>1</upper></limit></axis></joint></model></sdf>
"""
LIMB = """\
<sdf version="1.9"><model name="limb"><link name="limb"><pose>0 0 1 0 0 0</pose>
<collision name="c"><geometry><mesh><uri>meshes/limb.obj</uri></mesh></geometry></collision>
</link></model></sdf>
"""
GZ_ROOM = """\
<sdf version="1.8"><world name="room"><include><uri>model://block</uri></include><include>
<uri>https://fuel.gazebosim.org/1.0/maker/models/shelf</uri><pose>2 0 0 0 0 0</pose></include>
</world></sdf>
"""
GZ = """\
scenario: A robot and a world of Gazebo
robot: {sdf: arm.sdf}
world: {name: room.sdf, model_path: [models]}
steps: [{wait: 0.01}]
params: {n: 1}
parametrize: {n: [1, 2]}
"""
CONFIG = '<model><sdf version="1.8">model.sdf</sdf></model>'


@pytest.fixture(scope="module")
def gazebo(tmp_path_factory):
    """A folder with a run of an SDF's robot, in a world with models of two kinds of folders."""
    folder = tmp_path_factory.mktemp("gazebo")
    texts = {
        "a.scenario.yaml": GZ,
        "arm.sdf": GZ_ROBOT,
        "room.sdf": GZ_ROOM,
        "models/limb/model.sdf": LIMB,
        "models/limb/meshes/limb.obj": TETRAHEDRON,
        "models/block/model.config": CONFIG,
        "models/block/model.sdf": MODEL,
        f"{FUEL}/1/model.config": CONFIG,
        f"{FUEL}/1/model.sdf": MODEL.replace("block", "shelf"),
        "nod.py": "TIME = 1\n",
    }
    for name, text in texts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("GZ_FUEL_CACHE_PATH", str(folder / "fuel"))
        assert "2 passed" in (said := ran(folder)), said
        yield folder


@pytest.mark.nightly(but=[f"{FUEL}/1/model.sdf"])
@pytest.mark.parametrize(
    "name",
    [
        "arm.sdf",
        "models/limb/model.sdf",
        "models/limb/meshes/limb.obj",
        "models/block/model.config",
        "models/block/model.sdf",
        f"{FUEL}/1/model.sdf",
        f"{FUEL}/2",
    ],
)
def test_a_changed_model_of_gazebo_is_noticed(gazebo, name):
    assert is_known(gazebo)
    path = gazebo / name
    before = path.read_bytes() if path.is_file() else None
    if before is None:  # a newer version that was downloaded
        shutil.copytree(path.with_name("1"), path)
    else:
        path.write_bytes(before + b"\n")
    try:
        assert not is_known(gazebo)
    finally:
        if before is None:
            shutil.rmtree(path)
        else:
            path.write_bytes(before)


def is_known(folder):
    """Whether the result of a folder's scenario is from the files that stand there now."""
    return forked(same_inputs, folder).result == [True]


def same_inputs(folder, _notify):
    os.chdir(folder)
    sys.path.insert(0, str(folder))
    load_plugin("nod.py")
    found = Stream(Path("reports"), resume=True)
    return [found._has_same_inputs(each) for each in found._inputs]  # noqa: SLF001


def test_the_copy_of_a_project_has_the_same_inputs(project, tmp_path):
    copy = tmp_path / "copy"
    shutil.copytree(project, copy)
    assert is_known(copy)
