"""Objects whose pose is in the frame of an object that stands there before."""

import numpy as np
import pytest

from tests.session.front_door import problems, run

OM = "open_manipulator_x"
TABLE = (
    "{name: table, static: true, pose: {xyz: [0.5, 0.2, 0.1], rpy: [0, 0, 90 deg]}, "
    "box: {size: [0.2, 0.2, 0.2]}}"
)
CUBE = (
    "{{name: cube, pose: {{frame: {0}, xyz: [0.05, 0, 0.12]}}, box: {{size: [0.04, 0.04, 0.04]}}}}"
)
WAIT = "- wait: 0.05 s"


def objects(*lines):
    return "objects:\n" + "".join(f"  - {line}\n" for line in lines)


def test_an_object_stands_on_another_one_turned_with_it(tmp_path):
    _, saved = run(tmp_path, WAIT, robot=OM, rest=objects(TABLE, CUBE.format("table")))
    assert saved.signals.object_poses["cube"][0, :3] == pytest.approx([0.5, 0.25, 0.22], abs=1e-6)


def test_a_chain_of_frames_is_followed(tmp_path):
    rest = objects(
        TABLE, CUBE.format("table"), CUBE.format("cube").replace("name: cube", "name: b")
    )
    _, saved = run(tmp_path, WAIT, robot=OM, rest=rest)
    assert saved.signals.object_poses["b"][0, :3] == pytest.approx([0.5, 0.3, 0.34], abs=1e-3)


def test_the_frame_of_an_object_of_the_world_file(tmp_path):
    world = f"world: w\nobjects:\n  - {TABLE}\n  - {CUBE.format('table')}\n"
    (tmp_path / "w.yaml").write_text(world)
    rest = objects(CUBE.format("cube").replace("name: cube", "name: b"))
    _, saved = run(tmp_path, WAIT, robot=OM, world="w.yaml", rest=rest)
    assert saved.signals.object_poses["b"][0, :3] == pytest.approx([0.5, 0.3, 0.34], abs=1e-3)


def test_an_unusable_object_that_is_replaced_costs_none_after_it(tmp_path):
    broken = "{name: table, static: true, mesh: {file: none.stl}}"
    world = f"world: w\nobjects:\n  - {broken}\n  - {CUBE.format('world')}\n"
    (tmp_path / "w.yaml").write_text(world)
    replaced = TABLE.replace("{name", "{replace: true, name")
    rest = objects(replaced) + "expect: [{upright: cube}]\n"
    result, _ = run(tmp_path, WAIT, robot=OM, world="w.yaml", rest=rest)
    assert result.verdicts[0].status == "passed"


def test_the_frame_of_a_link_is_where_the_link_starts(tmp_path):
    cube = CUBE.format("end_effector_link").replace("{name", "{static: true, name")
    _, saved = run(tmp_path, WAIT, robot=OM, rest=objects(cube))
    tcp = saved.signals.tcp_pose[0, :3]
    assert saved.objects[-1].pose[:3] == pytest.approx(np.add(tcp, (0.05, 0, 0.12)), abs=1e-4)
    assert tcp[2] > 0.1


@pytest.mark.nightly
def test_a_scene_has_a_thousand_objects_at_most(tmp_path):
    dot = "{{name: o{}, static: true, pose: {{xyz: [5, 5, 5]}}, sphere: {{radius: 1 mm}}}}"
    rest = objects(*(dot.format(number) for number in range(1000)))  # and the floor
    [(line, message)] = problems(tmp_path, WAIT, robot=OM, rest=rest)
    assert (line, message) == (7, "there are 1001 objects; a scene may have 1000")


@pytest.mark.parametrize("frame", ["tabl", "cube", "later"])
def test_an_object_that_does_not_stand_there_before_is_no_frame(tmp_path, frame):
    later = TABLE.replace("name: table", "name: later")
    [(_, message)] = problems(tmp_path, WAIT, robot=OM,
                              rest=objects(TABLE, CUBE.format(frame), later))  # fmt: skip
    assert f"'{frame}'" in message
