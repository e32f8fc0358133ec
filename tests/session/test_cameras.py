"""Names of cameras, and what carries them, are checked before anything moves."""

import pytest

from harness.core.errors import RobotError
from harness.core.resources import data_folder
from harness.core.spatial import SE3
from harness.language.scenario import RobotSpec
from harness.plugins.cameras.keys.marker import MarkerSpec
from harness.robot.load import load_robot
from harness.session.prepare import prepare
from tests.session.front_door import problems

OM = "open_manipulator_x"
LOOK = "- capture: gripper_camera"


def found(tmp_path, rest="", steps=LOOK, **words):
    return problems(tmp_path, steps, robot=OM, world="lesson_om", rest=rest, **words)


def test_a_robots_camera_is_there_by_its_name(tmp_path):
    assert found(tmp_path) == []


def test_a_camera_that_is_not_there_is_named_at_its_place(tmp_path):
    assert found(tmp_path, steps="- capture: griper_camera") == [
        (5, "there is no camera 'griper_camera'")
    ]
    rest = "videos: [griper]\nexpect:\n  - sees: {camera: wrist, object: red_bx}\n"
    assert found(tmp_path, rest) == [
        (6, "there is no camera 'griper'"),
        (8, "there is no camera 'wrist'"),
        (8, "there is no object 'red_bx'"),
    ]


def test_what_a_camera_stands_on_must_be_there(tmp_path):
    rest = """
    cameras:
      - {name: a, pose: {frame: red_boks}}
      - {name: b, pose: {frame: link5}}
      - {name: c, pose: {frame: red_box}}
      - {name: d}
    """
    assert found(tmp_path, rest) == [(8, "there is no frame 'red_boks'")]


def test_no_camera_stands_on_what_only_the_planner_knows(tmp_path):
    rest = """
    objects: [{name: ghost, in: planning, static: true, box: {size: [1, 1, 1]}}]
    cameras: [{name: a, pose: {frame: ghost}}]
    """
    ((line, message),) = found(tmp_path, rest)
    assert line == 8
    assert "planner alone" in message


def test_no_camera_sees_what_only_the_planner_knows(tmp_path):
    rest = """
    objects: [{name: ghost, in: planning, static: true, box: {size: [1, 1, 1]}}]
    expect: [{sees: {camera: gripper_camera, object: ghost}}]
    """
    ((line, message),) = found(tmp_path, rest)
    assert line == 8
    assert "planner alone" in message


def test_two_cameras_have_two_names(tmp_path):
    rest = "cameras: [{name: gripper_camera}, {name: a}, {name: a}]"
    assert [message for _, message in found(tmp_path, rest)] == [
        "another camera is called 'gripper_camera'",
        "another camera is called 'a'",
    ]


def test_a_camera_of_the_world_on_a_link_that_this_robot_has_not_is_reported_at_the_world(tmp_path):
    (tmp_path / "cell.yaml").write_text("world: cell\ncameras: [{name: a, pose: {frame: tool0}}]\n")
    ((line, message),) = problems(tmp_path, "- wait: 1 s", robot=OM, world="cell.yaml")
    assert line == 3
    assert "'a' is on 'tool0'" in message


def test_a_video_is_no_faster_than_its_camera(tmp_path):
    rest = "videos: [{camera: gripper_camera, rate: 30 Hz}, gripper_camera]"
    assert [message for _, message in found(tmp_path, rest)] == [
        "'gripper_camera' takes 20 pictures a second, not 30",
        "'gripper_camera' is recorded already",
    ]


@pytest.mark.parametrize(
    ("camera", "message"),
    [
        ("{name: a, image: {width: 100000}}", "2048"),
        ("{name: a, clip: {near: 2, far: 1}}", "less than `far`"),
        ("{name: a, horizontal_fov: 200 deg}", "2.9"),
        ("{name: a, look_at: [0, 0, 0]}", "where the camera is"),
        ("{name: a, look_at: [1, 0, 0], pose: {rpy: [0, 0, 1]}}", "not both"),
        ("{name: a, update_rate: 20 cm}", "a rate"),
    ],
)
def test_numbers_that_make_no_camera_are_refused_at_their_line(tmp_path, camera, message):
    ((line, said),) = found(tmp_path, f"cameras:\n  - {camera}")
    assert line == 7
    assert message in said


def test_a_camera_of_a_robots_folder_on_an_unknown_link_is_reported_with_the_nearest(tmp_path):
    folder = data_folder("robots") / OM
    for file in folder.iterdir():
        text = file.read_text()
        if file.name == "robot.yaml":
            text = text.replace("link: gripper_camera_link\n", "link: griper_camera_link\n")
        (tmp_path / file.name).write_text(text)
    with pytest.raises(
        RobotError, match=r"cameras\.gripper_camera\.link: there is no link"
    ) as caught:
        load_robot(RobotSpec(model="."), tmp_path)
    assert "did you mean `gripper_camera_link`" in str(caught.value)


def test_a_marker_is_a_plate_to_planner_and_physics_and_black_boxes_to_the_eye(tmp_path):
    path = tmp_path / "a.scenario.yaml"
    path.write_text(
        "scenario: a\nrobot: open_manipulator_x\nobjects:\n"
        "  - {name: card, static: true, marker: {id: 7, size: 6 cm}}\nsteps: [{wait: 1 s}]\n"
    )
    card = {obj.name: obj for obj in prepare(path).program.world.objects}["card"]
    (shape,) = card.shapes
    assert shape.geometry.size == pytest.approx((0.08, 0.08, 0.001))
    black = card.visuals[1:]
    # the border's cells and the black ones inside, of 6 x 6 cells of 1 cm
    area = sum(look.geometry.size[0] * look.geometry.size[1] for look in black)
    assert area * 1e4 == pytest.approx(round(area * 1e4))
    assert 20 <= round(area * 1e4) < 36
    assert len(black) < 16


def test_the_white_margin_is_one_cell_or_what_the_file_says():
    assert MarkerSpec(id=0, size=0.06).solid().size[0] == pytest.approx(0.08)
    assert MarkerSpec(id=0, size=0.06, margin=0.05).solid().size[0] == pytest.approx(0.16)
    assert len(MarkerSpec(id=0, size=0.06).printed(SE3.identity(), "")) > 1
