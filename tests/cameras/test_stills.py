"""A still shows what was recorded, with every backend the machine has."""

import os
import subprocess
import sys
from contextlib import closing
from dataclasses import replace

import cv2
import numpy as np
import pinocchio as pin
import pytest

from harness.core.details import Details
from harness.core.geometry import Mesh, Shape
from harness.core.spatial import SE3
from harness.language.scenario import RobotSpec
from harness.plugins.cameras import stills
from harness.plugins.cameras.camera_scene import scene_poses
from harness.plugins.cameras.picture_model import build_picture_model
from harness.plugins.cameras.renderer import make_renderer
from harness.plugins.cameras.stills import MOST_STEPS, UNSEEN, StepRenderer, looks_alike, overview
from harness.plugins.cameras.viewpoint import fit_viewpoint
from harness.recording.step_results import SceneChange
from harness.robot.load import load_robot
from tests.cameras.recorded_runs import IMAGINED, OBJECTS, RED_BOX, a_run
from tests.running import run_case

SIZE = 640, 480


def draw(description, run, sample, backend):
    picture = build_picture_model(
        description, OBJECTS, floor_height=0.0, width=SIZE[0], height=SIZE[1]
    )
    picture.pose(scene_poses(description, OBJECTS, run, sample))
    try:
        renderer = make_renderer(picture, *SIZE, backend)
    except RuntimeError as error:
        pytest.skip(str(error))
    try:
        return renderer.render(overview(description, OBJECTS, run, range(4)).view)
    finally:
        renderer.close()


def pixel(viewpoint, point):
    """Column and row of a point in the world."""
    x, y, z = viewpoint.view.pose.inverse().apply(np.asarray(point))
    focal = 0.5 * SIZE[1] / np.tan(np.radians(viewpoint.field_of_view) / 2)
    return round(SIZE[0] / 2 + focal * x / -z), round(SIZE[1] / 2 - focal * y / -z)


def mean_colour(picture, viewpoint, point):
    column, row = pixel(viewpoint, point)
    return picture[row - 3 : row + 4, column - 3 : column + 4].reshape(-1, 3).mean(axis=0)


@pytest.mark.nightly(but=["egl"])
@pytest.mark.parametrize("backend", ["egl", "osmesa", "rays"])
def test_objects_are_drawn_where_they_were_recorded(ur3e, backend):
    run = a_run(ur3e)
    viewpoint = overview(ur3e, OBJECTS, run, range(4))
    place = RED_BOX.pose.translation
    raised = place + np.array([0, 0, 0.2])
    red, green, blue = mean_colour(draw(ur3e, run, 0, backend), viewpoint, place)
    assert red > 2 * max(green, blue)
    red, green, blue = mean_colour(draw(ur3e, run, 1, backend), viewpoint, raised)
    assert red > 2 * max(green, blue)
    red, green, blue = mean_colour(draw(ur3e, run, 2, backend), viewpoint, place)
    assert red < 1.2 * max(green, blue)  # it was removed


@pytest.mark.nightly
@pytest.mark.parametrize("backend", ["egl", "osmesa", "rays"])
def test_an_object_of_the_planner_alone_is_translucent(ur3e, backend):
    run = a_run(ur3e)
    viewpoint = overview(ur3e, OBJECTS, run, range(4))
    place = IMAGINED.pose.translation
    ghost = mean_colour(draw(ur3e, run, 0, backend), viewpoint, place)
    floor = mean_colour(draw(ur3e, run, 2, backend), viewpoint, place)
    assert ghost[2] > 1.15 * ghost[0]  # blue
    assert ghost[0] > 50  # but the floor shines through
    assert abs(floor[2] - floor[0]) < 15


@pytest.mark.nightly
def test_rays_and_graphics_library_draw_the_same_picture(ur3e):
    run = a_run(ur3e)
    first, second = (draw(ur3e, run, 0, name).astype(float) for name in ("egl", "rays"))
    edges = [cv2.Canny(image.astype(np.uint8), 80, 160) > 0 for image in (first, second)]
    near = cv2.dilate(edges[1].astype(np.uint8), np.ones((7, 7))) > 0
    assert near[edges[0]].mean() > 0.6
    assert np.abs(first - second).mean() < 25


def stills_of(robot, objects, backend="auto"):
    with closing(StepRenderer(robot, objects, backend)) as renderer:
        return renderer.draw(a_run(robot))


def test_one_picture_is_drawn_for_each_executed_step(ur3e):
    stills = stills_of(ur3e, OBJECTS)
    assert list(stills.files) == [f"0{i + 1}-step-{i}.jpg" for i in range(4)]
    for content in stills.files.values():
        picture = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_COLOR)
        assert picture.shape == (480, 640, 3)
    assert (stills.note == "") is (stills.backend != "rays")


@pytest.mark.nightly(but=["0.01-3"])
@pytest.mark.parametrize(
    ("moved", "drawn"), [(0.0, 1), (0.2 * UNSEEN, 1), (2 * UNSEEN, 3), (0.01, 3), (np.nan, 2)]
)
def test_a_state_that_looks_like_the_one_before_is_drawn_once(ur3e, monkeypatch, moved, drawn):
    """The red box is moved on by as much until the third step; NaN takes it away."""
    views = []

    class Counted:
        def __init__(self, *arguments):
            self._renderer = make_renderer(*arguments)
            self.backend, self.close = self._renderer.backend, self._renderer.close

        def render(self, view):
            views.append(view)
            return self._renderer.render(view)

    monkeypatch.setattr(stills, "make_renderer", Counted)
    run = a_run(ur3e)
    still = np.tile(run.signals.object_poses["imagined"][0], (4, 1))
    red = np.tile(RED_BOX.pose.as_vector(), (4, 1))
    red[1:, 0] += np.arange(1, 4) * moved
    poses = {**run.signals.object_poses, "red_box": red, "imagined": still}
    run = replace(run, signals=replace(run.signals, object_poses=poses))
    with closing(StepRenderer(ur3e, OBJECTS)) as renderer:
        views.clear()
        assert len(renderer.draw(run).files) == 4
    assert len(views) == drawn


def test_states_that_turn_or_lose_a_body_do_not_look_alike():
    here, turned = SE3.identity(), SE3.from_xyz_rpy((0, 0, 0), (0, 0, 2 * UNSEEN))
    assert looks_alike({"cup": here}, {"cup": here})
    assert not looks_alike({"cup": here}, {"cup": turned})
    assert not looks_alike({"cup": here}, {})
    assert not looks_alike({"cup": here}, {"lid": here})


@pytest.mark.nightly
def test_without_a_graphics_library_the_rays_draw_and_the_note_says_so():
    """PyOpenGL with the name of a missing library stands for a machine without one."""
    program = """
from harness.plugins.cameras.stills import StepRenderer
from harness.robot.load import load_robot
from harness.language.scenario import RobotSpec
from tests.cameras.recorded_runs import OBJECTS, a_run
robot = load_robot(RobotSpec(model="open_manipulator_x"))
stills = StepRenderer(robot, OBJECTS).draw(a_run(robot))
print(stills.backend, len(stills.files), stills.note, sep="|")
"""
    environment = {
        **os.environ,
        "PYOPENGL_PLATFORM": "none",
        "PYTHONPATH": os.pathsep.join(sys.path),
    }
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True, text=True, env=environment, check=True,
    )  # fmt: skip
    assert done.stdout.strip() == (
        "rays|4|pictures by the ray camera: this machine has neither EGL nor OSMesa"
    )


def test_a_named_backend_that_is_not_there_is_an_error(ur3e):
    picture = build_picture_model(ur3e, (), floor_height=0.0, width=64, height=48)
    with pytest.raises(RuntimeError, match="no backend 'povray'"):
        make_renderer(picture, 64, 48, "povray")


def test_link_poses_are_those_of_pinocchio(ur3e):
    model = pin.buildModelFromXML(ur3e.urdf)
    data = model.createData()
    positions = ur3e.with_mimics(np.linspace(-0.5, 0.6, len(ur3e.joint_names)))
    q = pin.neutral(model)
    for name, position in zip(ur3e.joint_names, positions, strict=True):
        joint = model.joints[model.getJointId(name)]
        if joint.nq == 2:
            q[joint.idx_q : joint.idx_q + 2] = np.cos(position), np.sin(position)
        else:
            q[joint.idx_q] = position
    pin.framesForwardKinematics(model, data, q)
    poses = ur3e.link_poses(positions)
    for link in ur3e.link_names:
        expected = data.oMf[model.getFrameId(link)]
        np.testing.assert_allclose(poses[link].translation, expected.translation, atol=1e-9)
        np.testing.assert_allclose(poses[link].rotation, expected.rotation, atol=1e-9)


def test_an_object_of_the_planner_alone_is_drawn_where_it_is_believed(ur3e):
    run = a_run(ur3e)
    start = IMAGINED.pose.translation
    np.testing.assert_allclose(scene_poses(ur3e, OBJECTS, run, 0)["imagined"].translation, start)
    assert "imagined" not in scene_poses(ur3e, OBJECTS, run, 2)
    carried = scene_poses(ur3e, OBJECTS, run, 3)
    np.testing.assert_allclose(carried["imagined"].translation, np.add(start, (0, 0, 0.5)))
    assert "red_box" not in carried


def test_of_steps_at_one_moment_each_shows_what_was_there_after_it(ur3e):
    """A motion ends; at that moment one step adds an object, and another takes it out again."""
    run = a_run(ur3e)
    motion, adding, removing = (
        replace(
            run.steps[1], path=f"steps[{number}]", end_time=1.0, start_time=start, result=result
        )
        for number, start, result in (
            (0, 0.0, Details()),
            (1, 1.0, Details.of(SceneChange(added=("imagined",)))),
            (2, 1.0, Details.of(SceneChange(removed=("imagined",)))),
        )
    )
    run = replace(run, steps=(motion, adding, removing))
    shown = ["imagined" in scene_poses(ur3e, OBJECTS, run, 1, step) for step in run.steps]
    assert shown == [False, True, False]


@pytest.mark.parametrize("name", ["red_box", "imagined"])
def test_a_step_does_not_show_where_a_later_one_puts_an_object_at_its_end(ur3e, name):
    """A motion ends at sample 1; two steps put the object somewhere else, then time goes on.

    The physics shows that at sample 2, the planning scene at sample 1.
    """
    run = a_run(ur3e)
    at = np.tile(RED_BOX.pose.as_vector(), (4, 1))
    at[2 if name == "red_box" else 1 :, 2] += 0.3
    poses = {**run.signals.object_poses, name: at}
    put = {"verb": "move_object", "start_time": 1.0, "end_time": 1.0}
    moved = Details.of(SceneChange(moved=(name,)))
    other = Details.of(SceneChange(moved=("ground",)))
    motion = replace(run.steps[1], path="steps[0]", start_time=0.0, end_time=1.0)
    first, second = (
        replace(run.steps[1], path=f"steps[{number}]", result=result, **put)
        for number, result in ((1, other), (2, moved))
    )
    run = replace(
        run,
        steps=(motion, first, second),
        signals=replace(run.signals, object_poses=poses),
    )
    heights = [scene_poses(ur3e, OBJECTS, run, 1, step)[name].translation[2] for step in run.steps]
    assert heights == pytest.approx([0.05, 0.05, 0.35])


def test_the_overview_holds_every_point():
    rng = np.random.default_rng(3)
    points = rng.uniform(-1.0, 1.5, (200, 3))
    viewpoint = fit_viewpoint(points, np.zeros(200), *SIZE)
    columns, rows = np.array([pixel(viewpoint, point) for point in points]).T
    assert columns.min() >= 0
    assert columns.max() < SIZE[0]
    assert rows.min() >= 0
    assert rows.max() < SIZE[1]
    filled = max(np.ptp(columns) / SIZE[0], np.ptp(rows) / SIZE[1])
    assert filled > 0.7


@pytest.mark.parametrize("objects", [(), OBJECTS])
@pytest.mark.parametrize("size", [(640, 480), (960, 400)])
def test_an_overview_is_filled_by_the_arm_and_what_moved(ur3e, objects, size):
    """A table, and what stands far away, make neither small; a link's frame is in the picture."""
    far = replace(RED_BOX, name="far", pose=SE3.from_xyz_rpy((4, 4, 0.1)))
    run = a_run(ur3e)
    view = overview(ur3e, (*objects, far), run, range(4), size).view
    focal = 0.5 * size[1] / np.tan(np.radians(view.field_of_view) / 2)
    frames = [pose.translation for pose in ur3e.link_poses(run.signals.joint_positions[0]).values()]
    box = [RED_BOX.pose.apply(np.array([0, 0, 0.2]))] if objects else []
    local = np.array([view.pose.inverse().apply(point) for point in (*frames, *box)])
    seen = np.abs(focal * local[:, :2] / local[:, 2:]) / np.array(size) * 2
    assert seen.max() < 1
    assert np.ptp(focal * local[:, 1] / local[:, 2]) > 0.55 * size[1]


@pytest.mark.nightly
def test_a_mesh_that_cannot_be_drawn_is_named_in_the_note(ur3e, tmp_path):
    collada = Shape(Mesh(tmp_path / "mug.dae"), rgba=(1, 0, 0, 1))
    mug = replace(IMAGINED, name="mug", shapes=(collada,))
    assert stills_of(ur3e, OBJECTS, "rays").note == ""
    stills = stills_of(ur3e, (*OBJECTS, mug), "rays")
    assert stills.note == "not in the pictures: mug.dae; save them as OBJ or STL"


def test_a_colour_of_one_triangle_or_of_none_that_can_be_seen_is_no_error(ur3e, tmp_path):
    """MuJoCo refuses meshes of three corners, and those without an area."""
    corners = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nv 0.2 0 0\n"
    faces = "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 5\nusemtl c\nf 1 2 3\nf 1 2 4\n"
    (tmp_path / "mug.obj").write_text(corners + faces)
    mug = replace(IMAGINED, name="mug", shapes=(Shape(Mesh(tmp_path / "mug.obj")),))
    picture = build_picture_model(ur3e, (mug,), floor_height=0.0, width=64, height=48)
    assert picture.geoms["mug"].stop - picture.geoms["mug"].start == 2


@pytest.mark.nightly(but=["open_manipulator_x"])
@pytest.mark.parametrize("robot", ["open_manipulator_x", "ur3e", "ur10e"])
def test_the_floor_is_not_speckled_by_its_own_shadow(robot):
    """A coarse shadow map leaves no single dark pixels on a bright floor, in any direction."""
    description = load_robot(RobotSpec(model=robot))
    picture = build_picture_model(description, (), floor_height=0.0, width=640, height=480)
    picture.model.vis.quality.shadowsize, picture.model.vis.quality.offsamples = 1024, 0
    picture.pose({})
    try:
        renderer = make_renderer(picture, *SIZE, "egl")
    except RuntimeError as error:
        pytest.skip(str(error))
    try:
        for turn in (0.0, 1.5, 3.0, 4.5):
            points = np.array([[0, 0, 0], [2 * np.cos(turn), 2 * np.sin(turn), 0.2]])
            seen = renderer.render(fit_viewpoint(points, np.full(2, 0.5), *SIZE).view)
            gray = cv2.cvtColor(seen, cv2.COLOR_RGB2GRAY).astype(int)
            speckles = cv2.medianBlur(gray.astype(np.uint8), 5).astype(int) - gray > 40
            assert speckles.sum() < 20
    finally:
        renderer.close()


@pytest.mark.nightly
def test_a_run_of_many_steps_has_pictures_of_its_first_and_its_last(tmp_path):
    file = tmp_path / "many.scenario.yaml"
    steps = f"[repeat: {{times: {MOST_STEPS + 20}, steps: [wait: 2 ms]}}]"
    file.write_text(f"scenario: many\nrobot: open_manipulator_x\nsteps: {steps}\n")
    result = run_case(file, report_dir=tmp_path / "report", page=False)
    numbers = sorted(
        int(path.name.split("-")[0]) for path in (tmp_path / "report/images").iterdir()
    )
    half, count = MOST_STEPS // 2, MOST_STEPS + 21
    assert numbers == [*range(1, half + 1), *range(count - half + 1, count + 1)]
    assert f"the first {half} and the last {half} of {count} steps" in " ".join(result.notes)
