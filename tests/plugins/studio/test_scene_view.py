"""What pages draw of a cell: each body once, not too many triangles, poses that changed."""

import base64

import numpy as np
import pytest

from harness.core.geometry import Box, Mesh, Plane, Shape
from harness.language.scenario import RobotSpec
from harness.robot.load import load_robot

scene_view = pytest.importorskip("harness.plugins.studio.scene_view")


@pytest.fixture
def said():
    return []


@pytest.fixture
def view(said):
    return scene_view.SceneView(said.append)


@pytest.mark.parametrize("model", ["ur3e", "ur10e", "open_manipulator_x"])
def test_a_robot_has_at_most_20000_triangles(view, said, model):
    robot = load_robot(RobotSpec(model=model))
    view.show_robot(robot)
    view.show_robot(robot)
    [links] = said
    faces = [len(base64.b64decode(mesh["indices"])) // 12 for mesh in links["meshes"]]
    assert sum(faces) <= 20_000
    assert {body["name"] for body in links["bodies"]} <= set(robot.link_names)
    used = [n for body in links["bodies"] for s in body["shapes"] for n, _ in s.get("parts", ())]
    assert sorted(set(used)) == list(range(len(faces))), "each mesh is sent once and is used"


def test_meshes_that_are_used_twice_count_twice(tmp_path):
    import trimesh

    file = tmp_path / "ball.stl"
    trimesh.creation.icosphere(5, 0.05).export(file)  # 20,480 triangles
    mesh = Mesh(file, (1.0, 1.0, 1.0))
    once = scene_view.coarse_meshes([Shape(mesh)])
    twice = scene_view.coarse_meshes([Shape(mesh), Shape(mesh), Shape(Box((1, 1, 1)))])
    [one], [two] = once.values(), twice.values()
    count = [sum(len(part.faces) for part in parts) for parts in (one, two)]
    assert count[0] <= 20_000
    assert 0 < 2 * count[1] <= 20_000


def test_poses_are_sent_when_something_has_moved(view, said):
    robot = load_robot(RobotSpec(model="open_manipulator_x"))
    view.show_robot(robot)
    positions, pose = robot.start_positions(), np.array([0.2, 0, 0, 1, 0, 0, 0])
    for box in (pose, pose, pose + 1e-7):
        view.move(positions, {"box": box}, {"live": 1.0})
    assert [each["type"] for each in said] == ["links", "frame"]
    view.move(positions, {"box": pose + np.eye(7)[0] * 1e-3}, {})
    assert said[-1]["objects"]["box"][0] == pytest.approx(0.201)
    view.move(positions, {}, {})
    assert said[-1]["objects"] == {}, "what is no longer there is hidden"
    view.move(positions + 0.1, {}, {})
    links = robot.link_poses(positions + 0.1)
    sent = dict(zip((b["name"] for b in said[0]["bodies"]), said[-1]["links"], strict=True))
    for name, row in sent.items():
        assert row[:3] == pytest.approx(links[name].translation, abs=1e-5)


def test_a_page_that_comes_late_is_given_the_newest_of_everything(view, said):
    view.show_robot(load_robot(RobotSpec(model="open_manipulator_x")))
    ends = np.zeros((3, len(view._description.joint_names)))  # noqa: SLF001 - their number
    view.show_plan(ends, np.zeros((3, 3)), 2.0)
    view.show_plan(None)
    kinds = [each["type"] for each in view.greeting()]
    assert kinds == ["links", "plan"]
    assert view.greeting()[1]["frames"] == []
    assert len(said[1]["frames"]) == 3


def test_a_plane_is_a_floor():
    [body] = scene_view.bodies_message("objects", {"floor": [Shape(Plane())]}, {"floor": {}})[
        "bodies"
    ]
    assert body["shapes"][0]["kind"] == "plane"
