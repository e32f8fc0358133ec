"""Where things stand: nested poses, `relative_to`, placement frames, includes, merges."""

from pathlib import Path

import numpy as np
import pytest

from harness.core.errors import SpecError
from harness.core.spatial import SE3
from harness.plugins.formats.sdf.world import load_sdf
from tests.world.sdf_files import load, text_with

FRAMES = Path(__file__).parent / "files" / "frames.sdf"

# T_world_collision, xyz and quat wxyz, as libsdformat 12.3 (Debian 12) resolves that file;
# it prints six decimals.
RESOLVED = {
    "rack::post::c": (1.018479, 2.609175, 0.487585, 0.595909, 0.008801, 0.178258, 0.782968),
    "rack::plate::c": (1.024245, 2.706705, 0.818163, 0.256973, -0.148036, 0.312750, 0.902351),
    "rack::lamp::foot::c": (1.002960, 2.834807, 0.970272, 0.294063, -0.038428, 0.634258, 0.713979),
    "rack::lamp::head::c": (0.862363, 2.828061, 1.235201, 0.294063, -0.038428, 0.634258, 0.713979),
    "cup::body::c": (0.803378, 2.641294, 0.745167, 0.472759, 0.008517, 0.082143, 0.877313),
    "cup::handle::c": (0.766603, 2.621123, 0.802094, 0.468063, -0.035341, 0.105669, 0.876643),
    "bulb_cover::l::c": (0.890296, 2.898246, 1.242283, 0.276488, 0.107258, 0.898914, 0.322496),
    "crate_1::base::c": (1.028151, 1.861409, 1.100000, 0.880965, 0.000000, 0.000000, 0.473181),
    "crate_2::base::c": (5.000000, 5.000000, 5.100000, 0.968912, 0.000000, 0.000000, 0.247404),
    "merged::base::c": (2.198872, 0.514399, 0.087758, 0.850301, 0.217117, 0.118612, 0.464521),
    "merged::extra::c": (2.542136, 0.412831, 0.925525, 0.607961, 0.245976, 0.026545, 0.754437),
}


def test_every_collision_stands_where_libsdformat_has_it():
    world = load_sdf(FRAMES).world
    assert [item.name for item in world.objects] == [
        "rack", "cup", "bulb_cover", "crate_1", "crate_2", "merged",
    ]  # fmt: skip
    expected = iter(RESOLVED.items())
    for item in world.objects:
        poses = [shape.pose.se3() for shape in item.shapes]
        for pose in poses or [SE3.identity()]:  # one shape that stands where its object does
            name, resolved = next(expected)
            assert name.startswith(f"{item.name}::")
            found = (item.pose.se3() @ pose).as_vector()
            assert found == pytest.approx(resolved, abs=2e-6), name
    assert next(expected, None) is None


def test_degrees_and_quaternions_are_the_same_turn(tmp_path):
    poses = [
        "<pose>0 0 0 0 0 1.5707963267948966</pose>",
        "<pose degrees='true'>0 0 0 0 0 90</pose>",
        "<pose rotation_format='quat_xyzw'>0 0 0 0 0 0.7071067811865476 0.7071067811865476</pose>",
        "<pose rotation_format='quat_xyzw'>0 0 0 0 0 7 7</pose>",
    ]
    for pose in poses:
        turned = load(tmp_path, text_with("model", pose)).world.objects[0].pose
        assert turned.se3().apply(np.array([1.0, 0, 0])) == pytest.approx([0, 1, 0], abs=1e-12)
        assert turned.quat_wxyz == pytest.approx((0.5**0.5, 0, 0, 0.5**0.5), abs=1e-12)


@pytest.mark.parametrize("word", ["frame", "relative_to"])
def test_the_frame_of_a_pose_has_its_old_word_and_its_new_one(tmp_path, word):
    text = text_with("model", f"<pose {word}='cell'>0 0 1 0 0 0</pose>")
    assert load(tmp_path, text).world.objects[0].pose.xyz == (0, 0, 1.25)


@pytest.mark.parametrize(
    ("kind", "snippet", "message"),
    [
        ("model", "<pose relative_to='cel'>0 0 0 0 0 0</pose>", "there is no frame 'cel' here"),
        (
            "world",
            "<frame name='a'><pose relative_to='b'/></frame>"
            "<frame name='b'><pose relative_to='a'/></frame>"
            "<model name='n'><pose relative_to='a'/><link name='l'/></model>",
            "is relative to itself in a cycle",
        ),
        ("joint", "<parent>nothing</parent>", "there is no link or frame 'nothing' here"),
        ("collision", "<pose relative_to='x'>0 0 0 0 0 0</pose>", "there is no frame 'x' here"),
        ("model", "<frame name='l'/>", "'l' is defined twice"),
        ("model", "<link name='world'/>", "'world' is a reserved name"),
    ],
)
def test_a_frame_that_cannot_be_is_reported_at_its_place(tmp_path, kind, snippet, message):
    text = text_with(kind, snippet)
    with pytest.raises(SpecError, match=message) as caught:
        load(tmp_path, text)
    problem = caught.value.problems[0]
    assert problem.path == str(tmp_path / "world.sdf")
    assert problem.line > 1


def test_what_can_move_in_gazebo_is_held_here_and_reported(tmp_path):
    found = load(tmp_path, text_with().replace('type="fixed"', 'type="revolute"'))
    assert [item.name for item in found.world.objects] == ["m", "crate"]
    assert "the revolute joint 'j' is held in its initial position" in [
        n.message for n in found.notes
    ]


def test_links_that_nothing_joins_are_objects_of_their_own(tmp_path):
    text = text_with().replace('<joint name="j" type="fixed">', "<frame name='x'>")
    text = text.replace("<parent>l</parent><child>lid</child></joint>", "</frame>")
    world = load(tmp_path, text).world
    assert [item.name for item in world.objects] == ["m::l", "m::lid", "crate"]
    assert world.objects[1].pose.xyz == (0, 0, 1)


@pytest.mark.parametrize("stated", ["crate_3", "lyd", "crate::lid"])
def test_a_placement_frame_that_is_not_there_is_reported_where_it_is_named(tmp_path, stated):
    """In the including file; the included one has no mistake."""
    (tmp_path / "crate.sdf").write_text(
        "<sdf version='1.9'><model name='crate'><link name='body'/><frame name='lid'/></model>"
        "</sdf>"
    )
    include = f"""<include>
        <name>crate_3</name><uri>crate.sdf</uri>
        <placement_frame>{stated}</placement_frame>
      </include>"""
    file = tmp_path / "cell.sdf"
    file.write_text(f"<sdf version='1.9'><world name='cell'>\n{include}\n</world></sdf>")
    with pytest.raises(SpecError) as caught:
        load_sdf(file)
    [problem] = caught.value.problems
    assert (problem.path, problem.line) == (str(file), 4)
    assert problem.message == f"there is no frame '{stated}' in the model 'crate'"
    assert problem.hint.endswith("frames: __model__, body, lid")


def test_a_placement_frame_of_the_model_itself_is_reported_there(tmp_path):
    (tmp_path / "crate.sdf").write_text(
        "<sdf version='1.9'>\n<model name='crate' placement_frame='lyd'><link name='body'/></model>"
        "</sdf>"
    )
    file = tmp_path / "cell.sdf"
    file.write_text(
        "<sdf version='1.9'><world name='c'><include><uri>crate.sdf</uri></include></world></sdf>"
    )
    with pytest.raises(SpecError) as caught:
        load_sdf(file)
    [problem] = caught.value.problems
    assert (problem.path, problem.line) == (str(tmp_path / "crate.sdf"), 2)
    assert problem.message == "there is no frame 'lyd' here"
