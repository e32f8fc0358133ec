"""What a page's requests do: objects, handles, cameras, reach, undo."""

import base64
import time

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.resources import data_folder
from harness.core.spatial import SE3
from harness.plugins.studio.document import flow, new_text
from harness.plugins.studio.files import StudioFiles
from harness.plugins.studio.live_camera import PERIOD
from harness.plugins.studio.session import guarded
from harness.plugins.studio.texts import pose_keys_of, rpy_degrees

studio_module = pytest.importorskip("harness.plugins.studio.studio")
ROBOT = "open_manipulator_x"
ARM = {"model": ROBOT}
BOX = {"name": "box", "kind": "box", "size": [0.03, 0.03, 0.08], "xyz": [0.2, 0, 0.04]}


@pytest.fixture
def studio(tmp_path):
    return opened(tmp_path, new_text("by hand", ARM, "empty"))


def opened(folder, text):
    files = StudioFiles(folder, folder / "x.scenario.yaml")
    studio = studio_module.Studio.opened(files, text, None, "")
    studio.speed = 0.0
    return studio


def reply(studio, action, **keys):
    return guarded(lambda: studio.do(action, keys))


def goal(studio, xyz, pitch):
    return reply(studio, "goal", xyz=xyz, rpy=[0, pitch, 0], unit="deg", frame="world")


def test_objects_are_added_resized_and_deleted_in_the_text(studio):
    reply(studio, "add_object", **BOX)
    assert studio.cell.object_poses()["box"].translation[2] == pytest.approx(0.04)
    reply(studio, "add_object", **{**BOX, "kind": "sphere", "size": [0.05]})
    assert "sphere: {radius: 0.025}" in studio.text
    assert "box: {size" not in studio.text
    assert "belongs to the world" in reply(studio, "delete_object", name="ground_plane")["error"]
    assert reply(studio, "delete_object", name="box") == {}
    assert "objects" not in studio.text


def test_an_object_is_moved_in_the_text_at_the_start_and_with_a_step_afterwards(studio):
    reply(studio, "add_object", **BOX)
    turned = SE3.from_xyz_rpy([0.25, 0.1, 0.04], [0, 0, np.pi / 2])
    studio.put_object("box", turned)
    assert "xyz: [0.25, 0.1, 0.04], rpy: [0, 0, 90 deg]" in studio.text
    reply(studio, "execute", step="gripper: open")
    studio.put_object("box", SE3.from_xyz_rpy([0.2, -0.1, 0.04], [0, 0, 0]))
    assert "- move_object: {object: box, pose: {xyz: [0.2, -0.1, 0.04]}}\n" in studio.text
    assert studio.cell.is_run
    studio.session.at_once["recording"]({"on": False})
    text = studio.text
    studio.put_object("box", SE3.from_xyz_rpy([0.2, 0.1, 0.04], [0, 0, 0]))
    assert studio.text == text
    assert studio.cell.object_poses()["box"].translation[1] == pytest.approx(0.1, abs=1e-3)
    assert not studio.cell.is_run


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(
    ("kind", "size", "half", "larger", "center"),
    [
        ("box", [0.04, 0.04, 0.04], [0.03, 0.02, 0.03], [0.06, 0.04, 0.06], [0.21, 0, 0.03]),
        ("cylinder", [0.04, 0.04], [0.02, 0, 0.03], [0.04, 0.06], [0.2, 0, 0.03]),
        ("sphere", [0.04], [0, 0, 0.025], [0.05], [0.2, 0, 0.025]),
    ],
)
def test_a_dragged_face_resizes_and_the_opposite_face_stays(
    studio, kind, size, half, larger, center
):
    reply(studio, "add_object", name="a", kind=kind, size=size, xyz=[0.2, 0, 0.02])
    drag = {"kind": "size", "name": "a", "pose": [0, 0, 0, 1, 0, 0, 0], "end": True}
    assert reply(studio, "drag", **drag, half=half) == {}
    [form] = studio_module.robot_message(studio.cell)["objects"]
    assert (form["size"], form["xyz"]) == (pytest.approx(larger), pytest.approx(center))
    reply(studio, "execute", step="wait: 10 ms")
    text = studio.text
    assert "keeps its size" in reply(studio, "drag", **drag, half=[1, 1, 1])["error"]
    assert studio.text == text, "after the first step an object keeps its size"


@pytest.mark.parametrize("pose", [[0, 0, 0], [0] * 7, [float("nan")] * 7, "abc"])
def test_a_drag_to_no_pose_is_refused(studio, pose):
    assert "error" in reply(studio, "drag", kind="tcp", pose=pose, end=True)


def test_objects_that_overlap_are_shown_before_anything_moves(studio):
    reply(studio, "add_object", **{**BOX, "xyz": [0.2, 0, 0.03]})
    [overlap] = studio_module.robot_message(studio.cell)["overlaps"]
    assert overlap == "box and ground_plane overlap by 10.0 mm"


def test_a_refusal_names_the_limit_the_pair_or_the_distance(studio):
    reply(studio, "add_object", **BOX)
    assert "joint4 at" in goal(studio, [0.2, 0, 0.02], 0)["refusal"]
    assert "mm deep" in goal(studio, [0.2, 0, 0.015], 60)["refusal"]
    assert "m away" in goal(studio, [0.9, 0, 0.1], 0)["refusal"]
    assert studio.reach.nearest is not None, "what is drawn in red where no way exists"
    assert goal(studio, [0.2, 0, 0.15], 60) == {"refusal": "", "ways": 1}


def test_a_goal_is_recorded_in_the_chosen_frame(studio):
    reply(studio, "add_object", **BOX)
    shown = []
    studio.session.broadcast = lambda message, **_: shown.append(message)
    given = {"xyz": [0, 0, 0.11], "rpy": [0, 60, 0], "unit": "deg", "frame": "box"}
    assert reply(studio, "goal", **given)["ways"] == 1
    [reach] = [each for each in shown if each["type"] == "reach"]
    assert (reach["frame"], reach["pose"][:3]) == ("box", pytest.approx([0, 0, 0.11], abs=1e-6))
    done = reply(studio, "execute", verb="move_to", frame="box")
    assert done["step"] == ("move_to: {position: {frame: box, xyz: [0, 0, 0.11]}, pitch: 60 deg}")
    assert studio.cell.tcp_pose().translation == pytest.approx([0.2, 0, 0.15], abs=2e-3)


def test_an_arc_passes_through_a_point_of_the_frame_of_its_goal(studio):
    arc = {"verb": "circ", "frame": "link1", "interim": [0.2, 0, 0.16]}
    assert reply(studio, "goal", here=True, frame="link1")["ways"] == 1
    step = studio.motion_text(arc)
    assert step.endswith("interim: {frame: link1, xyz: [0.2, 0, 0.16]}}")
    for point in ([0], [0.2, 0, None]):
        assert "write its x, y and z" in reply(studio, "plan", **{**arc, "interim": point})["error"]


def test_the_handle_goes_to_the_tcp_exactly_where_no_rounded_pose_is_reached(tmp_path):
    studio = opened(tmp_path, new_text("by hand", {"model": "ur3e"}, "empty"))
    reached = reply(studio, "goal", here=True, frame="base_link")
    assert (reached["refusal"], reached["ways"] > 0) == ("", True)


def test_a_drag_goes_on_from_the_ghost_that_was_clicked(tmp_path):
    studio = opened(tmp_path, new_text("by hand", {"model": "ur3e"}, "empty"))
    down = {"rpy": [180, 0, 90], "unit": "deg"}
    reply(studio, "goal", xyz=[0.3, 0.1, 0.3], **down)
    names = [way.name for way in studio.reach.ways]
    assert len(names) > 3
    for name in names:
        [number] = [i for i, way in enumerate(studio.reach.ways) if way.name == name]
        clicked = studio.reach.ways[number].positions
        studio._choose(number)  # noqa: SLF001 - what a click in the scene does
        reply(studio, "goal", xyz=[0.3, 0.1, 0.302], **down)
        assert studio.reach.best.name == name
        assert studio.reach.best.positions == pytest.approx(clicked, abs=0.05)


JUDGED = """\
scenario: judged
robot: open_manipulator_x
steps:
  - ptp: {joints: {joint1: 0.3}}
    expect: [{joints: {positions: {joint1: 0.3}}}]
  - wait: 60 s
expect:
  - never: collision
"""


@pytest.mark.nightly
def test_a_verdict_is_shown_as_soon_as_its_step_has_ended(tmp_path):
    studio, verdicts = opened(tmp_path, JUDGED), []

    def hear(message, **_):
        if message["type"] == "verdicts":
            verdicts.append((studio.busy, message))
            studio.is_playing = True

    def hold_second_step(step, record):
        if record is None and step.summary == "wait 60 s" and not verdicts:
            studio.is_playing = False  # the physics waits for the verdict
        on_step(step, record)

    on_step, studio.cell.on_step = studio.cell.on_step, hold_second_step

    studio.session.broadcast = hear
    reply(studio, "run", until="end")
    busy, first = verdicts[0]
    assert busy == "wait 60 s", "the second step is still being executed"
    assert [(each["status"], each["open"]) for each in first["verdicts"]] == [
        ("passed", False),
        ("passed", True),
    ]
    assert (first["outcome"], first["digest"]) == ("", "")
    last = studio.verdicts.taken(wait=True)
    assert [each["open"] for each in last["verdicts"]] == [False, False]
    assert last["verdicts"][0]["margin"] == first["verdicts"][0]["margin"]
    assert (last["outcome"], len(last["digest"])) == ("passed", 64)


@pytest.mark.nightly
def test_a_digest_is_shown_of_the_text_and_the_run_on_the_page_alone(tmp_path):
    text = JUDGED.replace("wait: 60 s", "wait: 1 s")
    studio, digests = opened(tmp_path, text), []

    def hear(message, **_):
        if message["type"] == "verdicts":
            digests.append((studio.busy, studio.text, message["digest"]))

    studio.session.broadcast = hear
    reply(studio, "run", until="end")
    while not studio.verdicts._work._work.has_message():  # noqa: SLF001 - judged, but not shown
        time.sleep(0.01)
    reply(studio, "run", until="end")
    assert studio.verdicts.taken(wait=True)["digest"]
    reply(studio, "run", until="end")
    assert digests[-1][2] == "", "the old digest is taken away before the next run"
    assert studio.verdicts.taken(wait=True)["digest"]
    reply(studio, "edit", text=f"{text}# another text\n")
    assert digests[-1][2] == ""
    assert studio._greeting()[-1]["digest"] == ""  # noqa: SLF001 - what a page that comes back sees
    assert not [each for each in digests if each[0] and each[2]], "none while a step is executed"


MISTAKES = {
    "empty": ("", "none"),
    "not YAML": (f"scenario: x\nrobot: {ROBOT}\nsteps: [\n", "robot"),
    "no robot": ("scenario: x\nsteps: [{wait: 1 s}]\n", "none"),
    "an unknown robot": ("scenario: x\nrobot: open_manipulator_y\nsteps: []\n", "none"),
    "a step": (f"scenario: x\nrobot: {ROBOT}\nsteps: [{{wait: long}}]\n", "robot"),
    "a world": (f"robot:\n  model: {ROBOT}\nscenario: x\nworld: no\nsteps: []\n", "robot"),
}


@pytest.mark.nightly(but=["a step", "not YAML"])
@pytest.mark.parametrize("name", MISTAKES)
def test_a_text_with_mistakes_opens_with_what_can_be_shown(tmp_path, name):
    text, scene = MISTAKES[name]
    studio = opened(tmp_path, text)
    said = studio.document_message()
    assert (said["text"], said["scene"]) == (text, scene)
    assert said["problems"]
    assert "mistakes" in reply(studio, "run", until="end")["error"]
    if scene == "none":
        assert "there is no robot yet" in reply(studio, "reset")["error"]
    good = new_text("by hand", ARM, "empty")
    said = reply(studio, "edit", text=good)["document"]
    assert (said["scene"], said["problems"]) == ("whole", [])
    assert "error" not in reply(studio, "execute", step="wait: 10 ms")


def test_a_mistake_in_another_file_is_not_marked_in_the_text(tmp_path):
    (tmp_path / "w.yaml").write_text("world: w\nobjects: [{name: a, bix: {}}]\n")
    studio = opened(tmp_path, new_text("by hand", ARM, "w.yaml"))
    [problem, *_] = studio.document_message()["problems"]
    assert problem["line"] == 0
    assert "w.yaml:2" in problem["text"]


def test_a_goal_is_a_list_of_joint_positions_with_keys_of_the_planner(studio):
    planner = "planner_id: RRTConnect, planning_attempts: 2"
    goal_of = {"verb": "move_to", "joints": [20, 0, 0, 0], "unit": "deg", "planner": planner}
    done = reply(studio, "execute", **goal_of)
    assert done["step"].splitlines() == [
        "move_to: {joints: {joint1: 20 deg, joint2: 0, joint3: 0, joint4: 0}}",
        "planning: {planner_id: RRTConnect, planning_attempts: 2}",
    ]
    assert studio.cell.joint_positions()[0] == pytest.approx(0.349, abs=5e-3)
    refused = reply(studio, "plan", **{**goal_of, "joints": [20]})["error"]
    assert refused == "list 4 positions: joint1, joint2, joint3, joint4"
    assert "did you mean" in reply(studio, "plan", **{**goal_of, "planner": "RRTConect"})["error"]


def test_a_clicked_ghost_becomes_the_goal_of_the_page_that_controls(studio):
    goal(studio, [0.2, 0, 0.15], 60)
    studio._choose(0)  # noqa: SLF001 - what a click in the scene does
    done = reply(studio, "execute", verb="ptp")
    assert done["step"].startswith("ptp: {joints: {joint1: 0, joint2: ")
    assert studio.cell.tcp_pose().translation == pytest.approx([0.2, 0, 0.15], abs=2e-3)


def test_a_world_is_loaded_and_its_mistakes_are_refused(studio):
    assert reply(studio, "world", name="lesson_om") == {}
    assert "world: lesson_om" in studio.text
    before = studio.text
    assert "lesson_om" in reply(studio, "world", name="lesson_on")["error"]
    assert "outside" in reply(studio, "world", name="/etc/passwd")["error"]
    assert studio.text == before


def test_an_object_is_attached_and_detached_as_steps(studio):
    reply(studio, "add_object", **BOX)
    for step in ("attach_object: box", "detach_object: box"):
        assert reply(studio, "execute", step=step)["status"] == "passed"
    assert studio.cell.document.step_count == 2


def test_an_object_of_the_text_fills_the_fields(studio):
    reply(studio, "add_object", **{**BOX, "kind": "cylinder", "size": [0.04, 0.1]})
    [form] = studio_module.robot_message(studio.cell)["objects"]
    assert form.pop("half") == [0.02, None, 0.05]
    assert form == {"name": "box", "kind": "cylinder", "size": [0.04, 0.1], "xyz": [0.2, 0, 0.04]}


def test_undo_takes_the_step_out_of_the_text_and_the_state(studio):
    before, start = studio.text, studio.cell.joint_positions()
    reply(studio, "execute", step="ptp: {joints: {joint1: 0.4}}")
    assert studio.cell.document.step_count == 1
    reply(studio, "undo")
    assert studio.text == before
    assert np.array_equal(studio.cell.joint_positions(), start)


@pytest.mark.nightly
def test_what_is_seen_is_proposed_with_names_and_poses(studio):
    def seen():
        found = reply(studio, "expect_seen")["proposals"]
        return [each["text"].partition(", pose")[0] for each in found]

    reply(
        studio, "add_object", name="box", kind="box", size=[0.03, 0.03, 0.03], xyz=[0.2, 0, 0.015]
    )
    reply(studio, "execute", step="move_to: home")
    assert seen() == ["named_target: home"], "what has not moved is of no interest"
    for step in ("gripper: open", "pick: box"):
        assert reply(studio, "execute", step=step)["status"] == "passed"
    assert "grasped: box" in seen()
    place = "place: {object: box, pose: {xyz: [0.2, 0.05, 0.015]}}"
    assert reply(studio, "execute", step=place)["status"] == "passed"
    assert {"placed: {object: box, on: ground_plane", "upright: box"} <= set(seen())


def test_a_camera_shows_the_cell_as_it_is(tmp_path):
    file = data_folder("scenarios") / "cameras/01_gripper_camera.scenario.yaml"
    studio = opened(tmp_path, file.read_text())
    [name, *_] = studio.cell.prepared.program.cameras
    assert reply(studio, "camera", name=name) == {}
    studio.camera.draw(studio.cell)
    encoded = base64.b64decode(studio.camera.taken(wait=True)["image"])
    pixels = cv2.imdecode(np.frombuffer(encoded, np.uint8), cv2.IMREAD_COLOR)
    assert pixels.shape == (180, 240, 3)
    assert pixels.std() > 5
    time.sleep(PERIOD)
    studio.camera.draw(studio.cell)
    assert studio.camera.taken(wait=True) is None, "nothing has moved"
    assert "no camera 'other'" in reply(studio, "camera", name="other")["error"]


@pytest.mark.nightly
def test_expectations_that_observe_more_keep_the_steps_before_them(studio):
    reply(studio, "execute", verb="move_to", joints=[20, 0, 0, 0], unit="deg")
    links, positions = studio.cell.prepared.observed_links, studio.cell.joint_positions()
    assert reply(studio, "expect", texts=["tcp_pose: {link: link3, pose: {}}"]) == {}
    assert studio.cell.prepared.observed_links != links
    assert studio.busy == ""
    assert studio.cell.steps_done == 1
    assert studio.cell.joint_positions() == pytest.approx(positions, abs=1e-9)


def moved_by_hand(studio, positions):
    for joint, value in positions.items():
        assert reply(studio, "jog", joint=joint, value=value) == {}
    while studio.target is not None:
        studio._go_on(0.02)  # noqa: SLF001 - what the thread does between two pictures


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize("positions", [{"joint1": 0.4}, {"joint2": -0.5, "joint4": 0.3}])
def test_a_slider_then_execute_then_the_whole_run(studio, positions):
    moved_by_hand(studio, positions)
    assert reply(studio, "execute", verb="move_to")["status"] == "passed"
    assert studio.cell.document.step_count == 1
    assert reply(studio, "run", until="end") == {}
    assert studio.verdicts.taken(wait=True)["outcome"] == "passed"
    reached = studio.cell.joint_positions()
    for name, value in positions.items():
        index = studio.cell.description.joint_index[name]
        assert reached[index] == pytest.approx(value, abs=5e-3)


@pytest.mark.parametrize(
    "request_",
    [
        {"verb": "move_to", "here": True},
        {"verb": "ptp", "joints": [0, 0, 0, 0]},
    ],
    ids=["the positions of now", "a list"],
)
def test_nothing_is_recorded_where_nothing_moves(studio, request_):
    before = studio.text
    assert "no step was recorded" in reply(studio, "execute", **request_)["note"]
    assert (studio.text, studio.cell.steps_done) == (before, 0)
    assert studio.cell.is_run


def test_a_gripper_that_is_open_is_not_opened_again(studio):
    opens = {"step": "gripper: open", "if_moved": True}
    assert "note" not in reply(studio, "execute", **opens)
    assert "no step was recorded" in reply(studio, "execute", **opens)["note"]
    assert studio.cell.document.step_count == 1


def test_positions_are_recorded_after_motions_by_hand_and_not_twice(studio):
    moved_by_hand(studio, {"joint1": -0.3})
    assert "note" not in reply(studio, "execute", here=True)
    assert "joint1: -17.1" in studio.text
    text = studio.text
    assert "no step was recorded" in reply(studio, "execute", here=True)["note"]
    assert studio.text == text


@pytest.mark.parametrize(
    ("rpy", "written"),
    [
        ([180, 0, 90], "[180 deg, 0, 90 deg]"),
        ([0, 90, 0], "[0, 90 deg, 0]"),
        ([-150, 20, 45], "[-150 deg, 20 deg, 45 deg]"),
    ],
)
def test_poses_are_written_as_roll_pitch_and_yaw_in_degrees(rpy, written):
    pose = SE3.from_xyz_rpy([0.25, 0.1, 0.04], np.radians(rpy))
    assert flow(pose_keys_of(pose)) == f"{{xyz: [0.25, 0.1, 0.04], rpy: {written}}}"


@given(angles=st.tuples(*[st.floats(-180, 180)] * 3))
def test_the_written_angles_are_the_rotation(angles):
    pose = SE3.from_xyz_rpy([0, 0, 0], np.radians(angles))
    written = [float(str(each).removesuffix(" deg")) for each in rpy_degrees(pose.rotation)]
    again = SE3.from_xyz_rpy([0, 0, 0], np.radians(written))
    assert pose.distance_to(again)[1] < 1e-4


CELL = """\
scenario: a cell
robot: {model: ur3e, gripper: rh_p12_rn_a, wrench_sensors: {wrist: rh_p12_rn_base}}
objects:
  - {name: belt, static: true, surface_velocity: 0, box: {size: [1, 0.2, 0.1]},
     pose: {xyz: [0, -0.5, 0.05]}}
  - {name: can, cylinder: {radius: 3 cm, length: 8 cm}, mass: 0.2, pose: {xyz: [0, -0.5, 0.14]}}
  - name: cabinet
    static: true
    pose: {xyz: [0.9, 0, 0.35]}
    box: {size: [30 cm, 40 cm, 40 cm]}
    joints:
      - name: door
        hinge: {axis: [0, 0, -1], at: [-0.16, 0.2, 0], range: [0, 110 deg], friction: 0.1,
                start: 30 deg}
        shapes: [{box: {size: [2 cm, 40 cm, 38 cm]}, pose: {xyz: [-0.162, 0, 0]}}]
steps: []
"""


@pytest.mark.nightly
def test_a_cell_with_a_belt_a_door_and_a_wrist_sensor_is_shown_with_what_they_read(tmp_path):
    studio = opened(tmp_path, CELL)

    def shown():
        return dict(studio.state_message()["readings"])

    bodies = studio_module.robot_message(studio.cell)["bodies"]
    assert {"belt", "can", "cabinet", "cabinet/door"} <= {*bodies}
    assert shown()["belt"] == "surface 0 mm/s"
    assert shown()["cabinet/door"] == "30.0 deg"
    step = "conveyor: {object: belt, velocity: 10 cm/s}"
    assert reply(studio, "execute", step=step)["status"] == "passed"
    assert reply(studio, "execute", step="wait: 1 s")["status"] == "passed"
    assert shown()["belt"] == "surface 100 mm/s"
    assert studio.cell.object_poses()["can"].translation[0] == pytest.approx(0.11, abs=2e-3)
    links = studio.cell.description.links
    carried = sum(
        each.inertial.mass for each in links if each.name.startswith("rh_") and each.inertial
    )
    force = float(shown()["wrist"].split(" N")[0])
    assert force == pytest.approx(9.8 * carried, rel=0.02)
    assert reply(studio, "execute", step="tare: wrist")["status"] == "passed"
    assert reply(studio, "execute", step="wait: 100 ms")["status"] == "passed"
    assert shown()["wrist"].split(",")[0] == "0 N"
    wait = "wait: {until: {beam: {from: [0.3, -0.7, 0.14], to: [0.3, -0.3, 0.14]}}}"
    assert reply(studio, "execute", step=wait)["status"] == "passed"


TWO_ARMS = """\
scenario: two arms
robots:
  left: {model: open_manipulator_x, base: {xyz: [0, 0.3, 0]}}
  right: {model: open_manipulator_x, base: {xyz: [0, -0.3, 0]}}
steps: []
"""


def test_each_arm_of_a_cell_is_moved_and_recorded_by_its_name(tmp_path):
    studio = opened(tmp_path, TWO_ARMS)
    said = studio_module.robot_message(studio.cell)
    assert (said["arms"], said["arm"]) == (["left", "right"], "left")
    assert "the arms are left, right" in reply(studio, "arm", name="middle")["error"]
    for arm, side in (("right", -0.3), ("left", 0.3)):
        assert reply(studio, "arm", name=arm) == {}
        said = studio_module.robot_message(studio.cell)
        assert all(name.startswith(arm) for name in said["arm_joints"])
        assert studio.cell.tcp_pose().translation[1] == pytest.approx(side, abs=1e-3)
        assert goal(studio, [0.2, side, 0.15], 60) == {"refusal": "", "ways": 1}
        assert reply(studio, "execute", verb="move_to")["status"] == "passed"
        assert studio.cell.tcp_pose().translation == pytest.approx([0.2, side, 0.15], abs=2e-3)
        step = said["gripper"]["steps"]["open"]
        assert "note" not in reply(studio, "execute", step=step, if_moved=True)
    assert [studio.text.count(f"\n    robot: {arm}") for arm in ("left", "right")] == [2, 2]
    assert reply(studio, "run", until="end") == {}
    assert studio.verdicts.taken(wait=True)["outcome"] == "passed"


def test_the_clock_is_that_of_the_record_and_what_was_lived_never_goes_back(studio):
    def clocks():
        studio._frame(False)  # noqa: SLF001
        message = studio.state_message()
        return message["time"], message["live"]

    reply(studio, "advance", seconds=0.5)
    assert clocks() == (0.0, pytest.approx(0.5))
    reply(studio, "execute", step="wait: 100 ms")
    time, live = clocks()
    assert time == pytest.approx(0.1, abs=0.01), "physics between steps has no record"
    assert live >= 0.5
    reply(studio, "reset")
    assert clocks()[1] >= live
