"""Robots read from SDF: kinematics as Pinocchio has them, files of many kinds, located mistakes."""

import random
import re
from xml.etree import ElementTree

import numpy as np
import pinocchio
import pytest

from harness.core.errors import RobotError, SpecError
from harness.core.spatial import SE3, rpy_from_rotation
from harness.language.scenario import RobotSpec
from harness.plugins.formats.sdf.elements import READ
from harness.plugins.formats.sdf_robot.model import read_sdf_robot
from harness.plugins.formats.touching_links import urdf_poses
from harness.robot.load import load_robot
from harness.robot.packages import PackagePath
from harness.robot.robot_source import RobotSource
from tests.robot.sdf_format_rows import SDF
from tests.session.front_door import problems, run
from tests.world.sdf_files import ASCII_STL

CLOSE = 1e-9
LIMITS = {"lower": "-1", "upper": "1", "effort": "9", "velocity": "3"}


def load(folder, text=SDF, **words):
    (folder / "arm.sdf").write_text(text, encoding="utf-8")
    return load_robot(RobotSpec.model_validate({"sdf": "arm.sdf", **words}), folder)


def pose_text(pose):
    rpy = rpy_from_rotation(pose.rotation)
    return " ".join(repr(float(value)) for value in (*pose.translation, *rpy))


def a_pose(rng):
    return SE3.from_xyz_rpy(rng.uniform(-0.3, 0.3, 3), rng.uniform(-3, 3, 3))


class Tree:
    """A random tree of links, and its two descriptions.

    The URDF has each link at its joint; the SDF has links and joints where it likes, each relative
    to a frame of its choice.
    """

    def __init__(self, seed, version):
        rng = np.random.default_rng(seed)
        self.rng, self.version = rng, version
        count = int(rng.integers(2, 8))
        self.parents = [int(rng.integers(0, number)) for number in range(1, count)]
        kinds = ["revolute", "continuous", "prismatic", "fixed"]
        self.kinds = [str(rng.choice(kinds)) for _ in self.parents]
        self.kinds[0] = "revolute"
        self.links = [SE3.identity(), *(a_pose(rng) for _ in self.parents)]  # in the model
        is_at_child = rng.random(len(self.parents)) < 0.3
        self.on_child = [SE3.identity() if each else a_pose(rng) for each in is_at_child]
        axes = rng.normal(size=(len(self.parents), 3))
        self.axes = axes / np.linalg.norm(axes, axis=1)[:, None]  # in the joint's frame

    def joint(self, number):
        """The pose of a joint in the model."""
        return self.links[number + 1] @ self.on_child[number]

    def urdf(self):
        """The same tree for Pinocchio: a link at each joint, and the SDF's link fixed to it."""
        root = ElementTree.Element("robot", name="t")
        for number in range(len(self.links)):
            ElementTree.SubElement(root, "link", name=f"l{number}")

        def add(name, kind, parent, child, pose, axis=None):
            item = ElementTree.SubElement(root, "joint", name=name, type=kind)
            ElementTree.SubElement(item, "parent", link=parent)
            ElementTree.SubElement(item, "child", link=child)
            words = pose_text(pose).split()
            ElementTree.SubElement(item, "origin", xyz=" ".join(words[:3]), rpy=" ".join(words[3:]))
            if axis is not None:
                ElementTree.SubElement(item, "axis", xyz=" ".join(map(repr, map(float, axis))))
                ElementTree.SubElement(item, "limit", LIMITS)

        for number, (parent, kind) in enumerate(zip(self.parents, self.kinds, strict=True)):
            ElementTree.SubElement(root, "link", name=f"at{number}")
            front = self.links[parent].inverse() @ self.joint(number)
            add(f"j{number}", kind, f"l{parent}", f"at{number}", front, self.axes[number])
            back = self.on_child[number].inverse()
            add(f"f{number}", "fixed", f"at{number}", f"l{number + 1}", back)
        return ElementTree.tostring(root, encoding="unicode")

    def relative(self, place, choices):
        """A `<pose>` of a place in the model, relative to a frame of several."""
        name = str(self.rng.choice(list(choices)))
        on = f' relative_to="{name}"' if name != "__default__" else ""
        return f"<pose{on}>{pose_text(choices[name].inverse() @ place)}</pose>"

    def sdf(self):
        is_new = self.version >= (1, 7)
        frames = {"__default__": SE3.identity()}
        lines = []
        for number, place in enumerate(self.links):
            before = {f"l{number - 1}": self.links[number - 1]} if is_new and number else {}
            choices = frames | before
            lines.append(f'<link name="l{number}">{self.relative(place, choices)}</link>')
        for number, (parent, kind) in enumerate(zip(self.parents, self.kinds, strict=True)):
            place, child = self.joint(number), self.links[number + 1]
            choices = {"__default__": child}
            if is_new:
                choices |= {"__model__": SE3.identity(), f"l{parent}": self.links[parent]}
            axis, where = self.axes[number], ""
            own = "<use_parent_model_frame>1</use_parent_model_frame>"
            if self.version < (1, 5):
                axis, own = place.rotation @ axis, ""
            elif not is_new and self.rng.random() < 0.5:
                axis = place.rotation @ axis
            else:
                own = ""
            if is_new and self.rng.random() < 0.5:
                axis = self.links[parent].rotation.T @ place.rotation @ axis
                where = f' expressed_in="l{parent}"'
            xyz = " ".join(map(repr, map(float, axis)))
            limit = "".join(f"<{tag}>{value}</{tag}>" for tag, value in LIMITS.items())
            lines.append(
                f'<joint name="j{number}" type="{kind}">{self.relative(place, choices)}'
                f"<parent>l{parent}</parent><child>l{number + 1}</child>"
                f"<axis><xyz{where}>{xyz}</xyz><limit>{limit}</limit>{own}</axis></joint>"
            )
        self.rng.shuffle(lines)
        version = ".".join(map(str, self.version))
        return f'<sdf version="{version}"><model name="t">{"".join(lines)}</model></sdf>'


@pytest.mark.parametrize("version", [(1, 4), (1, 6), (1, 7), (1, 11)])
@pytest.mark.parametrize("seed", range(6))
def test_a_random_tree_moves_as_pinocchio_moves_it(tmp_path, seed, version):
    tree = Tree(seed, version)
    path = tmp_path / "tree.sdf"
    path.write_text(tree.sdf())
    urdf = read_sdf_robot(path, PackagePath.of_file(path), ()).urdf
    model = pinocchio.buildModelFromXML(tree.urdf())
    data = model.createData()
    for _ in range(5):
        q = pinocchio.neutral(model)
        positions = {}
        for joint in urdf.joints:
            if joint.is_movable:
                value = positions[joint.name] = float(tree.rng.uniform(-1, 1))
                place = model.joints[model.getJointId(joint.name)]
                two = [np.cos(value), np.sin(value)]
                q[place.idx_q : place.idx_q + place.nq] = two if place.nq == 2 else value
        pinocchio.framesForwardKinematics(model, data, q)
        poses = urdf_poses(urdf, positions)
        for number in range(len(tree.links)):
            judged = data.oMf[model.getFrameId(f"l{number}")].homogeneous
            assert np.abs(poses[f"l{number}"].matrix() - judged).max() < CLOSE


def parts(folder, text, name="arm.sdf"):
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def test_an_arm_of_included_models_has_its_meshes_and_its_hand(tmp_path):
    """The arm's file includes a hand of another folder, whose mesh is in its own model."""
    hand = """<sdf version="1.9"><model name="hand"><link name="palm"><collision name="c"><geometry>
      <mesh><uri>model://claw/meshes/palm.stl</uri></mesh></geometry></collision></link>
      <link name="jaw"><pose>0 0 0.1 0 0 0</pose></link>
      <joint name="pinch" type="prismatic"><parent>palm</parent><child>jaw</child><axis>
        <limit><lower>0</lower><upper>0.02</upper></limit></axis></joint></model></sdf>"""
    parts(tmp_path / "models", hand, "claw/model.sdf")
    parts(tmp_path / "models", ASCII_STL, "claw/meshes/palm.stl")
    included = """<include><name>claw</name><uri>model://claw</uri>
      <pose relative_to="wrist">0 0 0.1 0 0 0</pose></include>
      <joint name="mounted" type="fixed"><parent>wrist</parent><child>claw::palm</child></joint>
    </model>"""
    text = SDF.replace("</model>", included)
    arm = load(tmp_path, text)
    assert arm.joint_by_name["claw::pinch"].parent == "claw::palm"
    palm = next(link for link in arm.links if link.name == "claw::palm")
    assert palm.collisions[0].geometry.path == tmp_path / "models" / "claw" / "meshes" / "palm.stl"
    assert arm.joint_by_name["mounted"].pose.translation[2] == pytest.approx(0.1)


def test_the_robot_of_a_world_stands_where_the_world_has_it(tmp_path):
    body = SDF[SDF.index("<model") : SDF.index("</sdf>")]
    floor = '<model name="floor"><static>1</static><link name="l"/></model>'
    placed = body.replace('name="three">', 'name="three"><pose>0.5 0 0.7 0 0 0</pose>')
    world = f'<sdf version="1.9"><world name="w">{floor}{placed}</world></sdf>'
    arm = load(tmp_path, world)
    base = arm.joint_by_name["base_fixed"]
    assert base.pose.translation == pytest.approx([0.5, 0, 0.7])
    assert any("the model 'floor' is left out" in note for note in arm.notes)


@pytest.mark.parametrize("kind", ["fixed", "prismatic"])
def test_a_joint_to_the_world_holds_the_base_or_moves_it(tmp_path, kind):
    limit = "<axis><limit><lower>0</lower><upper>1</upper></limit></axis>"
    rail = (
        f'<joint name="rail" type="{kind}"><parent>world</parent><child>base</child>{limit}</joint>'
    )
    arm = load(tmp_path, SDF.replace("</model>", f"{rail}</model>"))
    assert ("rail" in {joint.name for joint in arm.movable_joints}) == (kind == "prismatic")
    assert ("robot_world" in arm.link_names) == (kind == "prismatic")


def test_limits_that_are_none_are_assumed_and_written_ones_count(tmp_path):
    text = SDF.replace("<effort>30</effort>", "<effort>-1</effort>")
    arm = load(tmp_path, text.replace("<lower>-2</lower><upper>2</upper>", ENDLESS))
    bend = arm.joint_by_name["bend"]
    assert (bend.kind, bend.velocity) == ("continuous", 1.5)
    assert bend.effort != 30
    assert arm.joint_by_name["reach"].upper == 0.2


ENDLESS = "<lower>-1.79769e+308</lower><upper>inf</upper>"


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ("<parent>lower</parent>", "<parent>gone</parent>", 16, "no link or frame 'gone' here"),
        ("0 0 0.5 0 0 0", "0 0 0.5", 6, "<pose>: expected 6 finite numbers"),
        ("<mass>1</mass>", "<mass>-1</mass>", 3, "link 'base' weighs -1 kg"),
        ("<upper>2</upper>", "<upper>two</upper>", 14, "<upper>: expected a number"),
        ("<xyz>0 1 0</xyz><limit>", "<xyz>0 0 0</xyz><limit>", 14, "an axis must not be 0 0 0"),
        ('relative_to="upper"', 'relative_to="uper"', 5, "there is no frame 'uper' here"),
        ("<child>wrist</child>", "<child>upper</child>", 16, "child of two joints"),
    ],
)
def test_a_mistake_in_the_file_is_located(tmp_path, old, new, line, message):
    assert old in SDF
    parts(tmp_path, SDF.replace(old, new, 1))
    [(found, said), *_] = problems(tmp_path, "- wait: 0.1 s", robot="{sdf: arm.sdf}")
    assert message in said
    assert found == line


@pytest.mark.parametrize(
    ("kind", "place"),
    [
        ("robot", '<link name="base">'),
        ("robot/axis", "<xyz>0 1 0</xyz><limit><lower>-2"),
        ("robot/limit", "<lower>-2"),
        ("robot/dynamics", ""),
    ],
)
def test_an_element_that_is_not_read_is_reported(tmp_path, kind, place):
    """One in each kind of element that robots alone have."""
    assert kind in READ
    extra = "<gz:extra>0.3</gz:extra>"
    changed = SDF.replace(place, extra + place, 1) if place else SDF.replace(
        "<axis><xyz>0 1 0</xyz><limit><lower>-2",
        f"<axis><dynamics>{extra}</dynamics><xyz>0 1 0</xyz><limit><lower>-2",
    )  # fmt: skip
    found = set(load(tmp_path, changed).notes) - set(load(tmp_path).notes)
    tag = kind.partition("/")[2] or "model"
    assert [f"<gz:extra> of <{tag}> is left out" in note for note in found] == [True]


@pytest.mark.parametrize("seed", range(40))
def test_a_damaged_file_is_a_robot_or_a_located_mistake(tmp_path, seed):
    """Letters are cut, words exchanged, numbers made absurd: an error of its place, or a robot."""
    rng = random.Random(seed)
    text = SDF
    for _ in range(rng.randint(1, 4)):
        words = [(each.start(), each.end()) for each in re.finditer(r"[\w.-]+", text)]
        start, end = rng.choice(words)
        other = text[slice(*rng.choice(words))]
        new = rng.choice(["", other, "nan", "1e400", "-5", "0", "<", text[start:end] * 200])
        text = text[:start] + new + text[end:]
    try:
        load(tmp_path, text)
    except (SpecError, RobotError) as error:
        found = error.problems if isinstance(error, SpecError) else []
        assert all(each.path == str(tmp_path / "arm.sdf") for each in found)
        assert all(each.line > 0 for each in found)


@pytest.mark.parametrize("name", ["arm.sdf", "arm.world", "arm.xml"])
def test_the_command_line_recognises_a_robot_in_sdf(tmp_path, name):
    path = parts(tmp_path, SDF, name)
    assert RobotSource(str(path)).kind == "sdf"


def test_a_scenario_moves_an_arm_in_sdf_and_grips(tmp_path):
    """Shapes, limits and the hand of the file are what planner and physics have."""
    box = "<geometry><box><size>0.02 0.01 0.06</size></box></geometry>"
    box = f"<collision name='c'>{box}</collision>"
    text = SDF
    for finger in ("left", "right"):
        link = f'<link name="{finger}">'
        assert link in text
        text = text.replace(link, link + box)
    parts(tmp_path, text)
    steps = """
    - gripper: open
    - move_to: {joints: {turn: 0.5, bend: 0.4, reach: 0.1}}
    - gripper: close
    """
    result, saved = run(tmp_path, steps, robot="{sdf: arm.sdf, collision: hull}")
    assert result.outcome == "passed"
    assert saved.signals.joint_positions[-1][:3] == pytest.approx([0.5, 0.4, 0.1], abs=2e-3)
