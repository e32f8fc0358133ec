"""A scenario may name any file of the machine; messages do not repeat what stands in it."""

import pytest

from harness.cli.main import main

SECRET = "hunter2"
FOREIGN = {
    "passwd": f"root:{SECRET}:0:0:root:/root:/bin/sh\nbin:{SECRET}:1:1\n",
    "config.yaml": f"token: {SECRET}\nusers: [{SECRET}\n",
    "keys.yaml": f"{SECRET}: {SECRET}\n",
    "settings.xml": f"<settings>\n <server><password>{SECRET}</password></settings>\n",
    "page.html": f"<!DOCTYPE {SECRET}>\n<html {SECRET}='1'></html>\n",
    "empty": "",
}
KEYS = {
    "include": "robot: ur3e\nsteps:\n  - include: §FILE\n",
    "include in an include": "robot: ur3e\nsteps:\n  - include: own.steps.yaml\n",
    "urdf": "robot: {urdf: §FILE}\nsteps: [settle]\n",
    "xacro": "robot: {xacro: §FILE}\nsteps: [settle]\n",
    "mjcf": "robot: {mjcf: §FILE}\nsteps: [settle]\n",
    "srdf": "robot: {urdf: arm.urdf, srdf: §FILE}\nsteps: [settle]\n",
    "kinematics": "robot: {model: ur3e, kinematics: §FILE}\nsteps: [settle]\n",
    "moveit joint limits": "robot: {model: ur3e, moveit: {joint_limits: §FILE}}\nsteps: [settle]\n",
    "moveit kinematics": "robot: {model: ur3e, moveit: {kinematics: §FILE}}\nsteps: [settle]\n",
    "world": "robot: ur3e\nworld: §FILE\nsteps: [settle]\n",
    "mesh": "robot: ur3e\nobjects: [{name: a, mesh: {file: §FILE}}]\nsteps: [settle]\n",
}
ARM = """<robot name="arm"><link name="base"/><link name="tip"/>
<joint name="j" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>
"""


@pytest.fixture
def folders(tmp_path):
    """A project's folder, and a folder next to it."""
    own, other = tmp_path / "own", tmp_path / "other"
    own.mkdir()
    other.mkdir()
    (own / "arm.urdf").write_text(ARM)
    return own, other


def checked(own, key, file, capsys):
    (own / "own.steps.yaml").write_text(f"steps:\n  - include: {file}\n")
    path = own / "foreign.scenario.yaml"
    path.write_text("scenario: x\n" + KEYS[key].replace("§FILE", str(file)))
    code = main(["check", str(path)])
    said = capsys.readouterr()
    return code, said.out + said.err


@pytest.mark.nightly(but=["include", "urdf", "world", "mesh"])
@pytest.mark.parametrize("key", KEYS)
def test_no_message_repeats_a_file_that_is_of_another_kind(folders, key, capsys):
    own, other = folders
    for name, text in FOREIGN.items():
        (other / name).write_text(text)
        suffix = ".yaml" if key == "world" else ".stl" if key == "mesh" else ""
        link = own / f"link_{name}{suffix}"
        link.symlink_to(other / name)
        for file in (other / name, link, f"../other/{name}"):
            code, said = checked(own, key, file, capsys)
            assert code == 2, said
            assert SECRET not in said


@pytest.mark.parametrize("how", ["absolute", "relative", "symbolic link", "link to a folder"])
def test_steps_outside_the_scenarios_folder_are_not_read(folders, how, capsys):
    own, other = folders
    (other / "good.steps.yaml").write_text("steps: [settle]\n")
    (own / "link.steps.yaml").symlink_to(other / "good.steps.yaml")
    (own / "linked").symlink_to(other)
    file = {
        "absolute": other / "good.steps.yaml",
        "relative": "../other/good.steps.yaml",
        "symbolic link": "link.steps.yaml",
        "link to a folder": "linked/good.steps.yaml",
    }[how]
    code, said = checked(own, "include", file, capsys)
    assert code == 2
    assert f"foreign.scenario.yaml:4:14: '{file}' is outside '{own.resolve()}'" in said


@pytest.mark.parametrize("mark", [".git", "pyproject.toml", "package.xml"])
def test_steps_of_the_scenarios_project_are_read(folders, mark, capsys):
    own, other = folders
    (own.parent / mark).touch()
    (other / "good.steps.yaml").write_text("steps: [settle]\n")
    code, said = checked(own, "include", "../other/good.steps.yaml", capsys)
    assert code == 0, said


def test_steps_below_the_scenarios_folder_are_read(folders, capsys):
    own, _ = folders
    (own / "common").mkdir()
    (own / "common/good.steps.yaml").write_text("steps: [settle]\n")
    code, said = checked(own, "include", "common/good.steps.yaml", capsys)
    assert code == 0, said


def test_a_mistake_in_a_robots_own_file_is_still_quoted(folders, capsys):
    own, other = folders
    (other / "arm.urdf").write_text(ARM.replace("</joint>", "</jiont>"))
    code, said = checked(own, "urdf", other / "arm.urdf", capsys)
    assert code == 2
    assert "</jiont>" in said
