"""Pictures agree with the pinhole, with what was recorded, and with each other."""

import io
from dataclasses import replace

import cv2
import numpy as np
import pytest

from harness.core.camera import OPTICAL
from harness.core.pose_arrays import compose
from harness.core.spatial import SE3
from harness.language.scenario import RobotSpec
from harness.plugins.cameras.camera_scene import CameraScene
from harness.plugins.cameras.renderer import make_renderer
from harness.robot.load import load_robot
from tests.cameras.camera_runs import ball, card, every, eye, image, pictures, robot, run_with
from tests.cameras.recorded_runs import an_object

PLACES = [(0.6, 0.0, 1.0), (0.6, 0.2, 1.15), (0.6, -0.25, 0.85), (1.2, 0.3, 0.7), (0.4, -0.1, 1.1)]


def centre_of(mask):
    """Middle of a mask's pixels, in the picture's continuous coordinates."""
    rows, columns = np.nonzero(mask)
    return np.array([columns.mean() + 0.5, rows.mean() + 0.5])


def predicted(camera, point):
    """By the camera matrix, from a camera that stands in the world."""
    local = camera.optical_pose.inverse().apply(np.array([point]))
    return camera.project(local)[0]


def depth_of(run, index=0):
    content = run.files[run.captures[index].files["depth"]]
    return np.load(io.BytesIO(content), allow_pickle=False)["depth"]


@pytest.mark.nightly(but=["egl-place0", "rays-place2"])
@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("backend", ["rays", "egl"])
def test_a_known_point_is_at_the_predicted_pixel(place, backend):
    camera = eye(horizontal_fov=1.3962634, width=320, height=240)
    run, objects = run_with([camera], [ball("ball", place, 0.012)])
    scene = CameraScene(robot(), objects, run.cameras)
    try:
        renderer = make_renderer(scene.picture, camera.width, camera.height, backend)
    except RuntimeError as error:
        pytest.skip(str(error))
    picture = renderer.render(scene.view(camera, scene.pose(run, 0))).astype(int)
    renderer.close()
    red = (picture[:, :, 0] > 90) & (picture[:, :, 0] > 2 * picture[:, :, 1:].max(axis=2))
    # a ball seen off the axis is an ellipse, its middle a little further out than its centre
    assert np.linalg.norm(centre_of(red) - predicted(camera, place)) < 0.8


def test_what_is_just_inside_the_field_of_view_is_seen_and_what_is_just_outside_is_not():
    camera = eye(horizontal_fov=1.0)
    for share, is_seen in ((0.97, True), (1.03, False)):
        angle = share * camera.horizontal_fov / 2
        place = (np.cos(angle), np.sin(angle), 1.0)
        run, objects = run_with([camera], [ball("ball", place, 0.008)])
        run = pictures(run, objects, every())
        label = run.captures[0].labels["ball"]
        assert (image(run, "segmentation") == label).any() == is_seen, share


def test_depth_is_in_metres_along_the_axis_and_endless_where_nothing_is():
    camera = eye(target=(1.0, 0.0, 1.0), clip_far=2.0)
    near = an_object("near", (0.1, 0.4, 0.4), (0.55, 0.2, 1.0), (0.9, 0, 0, 1))
    far = an_object("far", (0.1, 0.4, 0.4), (2.15, -0.4, 1.0), (0, 0.9, 0, 1))
    run, objects = run_with([camera], [near, far])
    run = pictures(run, objects, every())
    depth, labels = depth_of(run), image(run, "segmentation")
    front = labels == run.captures[0].labels["near"]
    assert depth.dtype == np.float32
    np.testing.assert_allclose(depth[front], 0.5, atol=1e-6)  # a flat face, off the axis too
    assert not (labels == run.captures[0].labels["far"]).any()  # at 2.1 m, beyond the clip
    assert np.isinf(depth[labels == 0]).all()
    assert np.isfinite(depth[labels > 0]).all()


def test_what_is_nearer_than_the_near_plane_is_looked_through():
    wall = an_object("wall", (0.1, 2.0, 2.0), (0.8, 0.0, 1.0), (0, 0.9, 0, 1))
    tiny = an_object("tiny", (0.01, 0.01, 0.01), (0.0, 0.0, 1.0), (0.9, 0, 0, 1))
    crossing = an_object("crossing", (0.2, 0.02, 0.02), (0.1, 0.0, 1.0), (0.9, 0, 0, 1))
    for thing in (tiny, crossing):
        run, objects = run_with([eye(clip_near=0.02)], [wall, thing])
        run = pictures(run, objects, every())
        assert (image(run, "segmentation") == run.captures[0].labels["wall"]).all(), thing.name
        np.testing.assert_allclose(depth_of(run), 0.75, atol=1e-6)


@pytest.mark.nightly
def test_the_share_of_an_outline_follows_what_hides_it():
    camera = eye(width=320, height=240)
    thing = an_object("thing", (0.02, 0.2, 0.2), (1.0, 0.0, 1.0), (0.9, 0, 0, 1))
    for edge, expected in ((-0.1, 1.0), (-0.05, 0.75), (0.0, 0.5), (0.08, 0.1), (0.12, 0.0)):
        # a wall at half the distance that covers everything right of `edge` in the thing's plane
        wall = an_object("wall", (0.001, 2.0, 2.0), (0.495, edge / 2 - 1.0, 1.0), (0, 0, 0.9, 1))
        run, objects = run_with([camera], [thing, wall])
        run = pictures(run, objects, every())
        shot = run.captures[0]
        seen = np.count_nonzero(image(run, "segmentation") == shot.labels["thing"])
        assert seen / shot.outlines["thing"] == pytest.approx(expected, abs=0.02), edge


def test_an_outline_goes_on_beyond_the_edge_of_the_picture():
    camera = eye()
    edge = np.tan(camera.horizontal_fov / 2) * 0.99
    thing = an_object("thing", (0.02, 0.2, 0.2), (1.0, edge, 1.0), (0.9, 0, 0, 1))
    run, objects = run_with([camera], [thing])
    run = pictures(run, objects, every())
    shot = run.captures[0]
    seen = np.count_nonzero(image(run, "segmentation") == shot.labels["thing"])
    assert seen / shot.outlines["thing"] == pytest.approx(0.5, abs=0.06)


def test_what_stands_behind_the_camera_has_no_outline():
    run, objects = run_with([eye()], [ball("front", (1, 0, 1)), ball("back", (-1, 0, 1))])
    shot = pictures(run, objects, every()).captures[0]
    assert "front" in shot.outlines
    assert "back" not in shot.outlines


def test_what_only_the_planner_believes_is_not_seen():
    ghost = an_object("ghost", (0.3, 0.3, 0.3), (1, 0, 1), (0.9, 0, 0, 1), simulated=False)
    run, objects = run_with([eye()], [ghost])
    run = pictures(run, objects, every())
    assert "ghost" not in run.captures[0].labels
    blue, green, red = image(run, "color")[60, 80].astype(int)
    assert red < 1.3 * min(blue, green)


def test_an_object_is_seen_where_it_was_at_the_moment_and_not_while_it_was_not_there():
    thing = ball("ball", (1.0, 0.0, 1.0), 0.05)
    rows = np.tile(thing.pose.as_vector(), (3, 1))
    rows[1, 1] = 0.3
    rows[2] = np.nan
    run, objects = run_with([eye()], [thing], n=3, poses={"ball": rows})
    run = pictures(run, objects, *(every(sample=sample) for sample in range(3)))
    masks = [image(run, "segmentation", i) == run.captures[i].labels["ball"] for i in range(3)]
    assert centre_of(masks[0])[0] == pytest.approx(80, abs=0.6)
    assert centre_of(masks[1])[0] == pytest.approx(predicted(eye(), (1.0, 0.3, 1.0))[0], abs=0.6)
    assert not masks[2].any()


def test_a_camera_on_an_object_goes_where_it_goes_and_takes_no_picture_while_it_is_away():
    carrier = an_object("carrier", (0.02, 0.02, 0.02), (0.0, 0.0, 1.0), (0, 0, 0.9, 1))
    rows = np.tile(carrier.pose.as_vector(), (3, 1))
    rows[1] = SE3.from_xyz_rpy((0.0, 0.0, 1.0), (0, 0, np.pi / 2)).as_vector()
    rows[2] = np.nan
    camera = replace(eye((0.02, 0, 0), (1, 0, 0)), frame="carrier", clip_near=0.02)
    seen = [ball("ahead", (1, 0, 1), 0.05), ball("left", (0, 1, 1), 0.05)]
    run, objects = run_with([camera], [carrier, *seen], n=3, poses={"carrier": rows})
    run = pictures(run, objects, *(every(sample=sample) for sample in range(3)))
    assert [shot.sample for shot in run.captures] == [0, 1]
    for index, name in enumerate(("ahead", "left")):
        labels = image(run, "segmentation", index)
        assert labels[60, 80] == run.captures[index].labels[name]
    expected = compose(rows[1:2], (camera.pose @ OPTICAL).as_vector())
    np.testing.assert_allclose(run.captures[1].pose, expected[0], atol=1e-9)


@pytest.mark.nightly
def test_the_gripper_camera_is_the_lessons():
    """Its place and view against the URDF, which has the lesson's numbers; noise and all."""
    description = load_robot(RobotSpec(model="open_manipulator_x"))
    camera = description.cameras["gripper_camera"]
    assert (camera.frame, camera.optical_frame_id) == (
        "gripper_camera_link",
        "gripper_camera_link_optical",
    )
    assert (camera.width, camera.height, camera.update_rate) == (640, 480, 20.0)
    assert (camera.clip_near, camera.clip_far) == (0.01, 15.0)
    assert (camera.noise_mean, camera.noise_stddev, camera.jpeg_quality) == (0.0, 0.007, 75)
    joint = next(j for j in description.joints if j.child == "gripper_camera_link_optical")
    assert joint.parent == camera.frame
    distance, angle = camera.optical_pose.distance_to(joint.pose)
    assert distance < 1e-12
    assert angle < 2e-4  # 1.5707 there is not quite a quarter turn
    run, objects = run_with([camera], [], description=description)
    shot = pictures(run, objects, every("gripper_camera"), description=description).captures[0]
    # at the start state `init` (all zero) link5 is at (0.036 + 0.124, 0, 0.0765 + 0.128 ...):
    # the camera looks along +x, 0.08 m before link5
    rotation = SE3.from_vector(shot.pose).rotation
    np.testing.assert_allclose(rotation @ [0, 0, 1], [1, 0, 0], atol=1e-9)
    np.testing.assert_allclose(rotation @ [1, 0, 0], [0, -1, 0], atol=1e-9)


@pytest.mark.parametrize(
    ("size", "xyz", "share"),
    [
        ((0.1, 16, 10), (1.05, 0, 1), 0.0064),
        ((0.1, 4, 2), (1.05, 0, 1), 0.128),
        ((0.1, 0.1, 6.0), (2.05, 0, 1), 0.277),
    ],
    ids=["a wall", "a smaller wall", "a post"],
)
def test_the_outline_of_what_is_larger_than_the_picture_is_counted_as_it_is(size, xyz, share):
    """A camera with a view of 45 degrees, 1 m before a wall: it shows 1.1 m x 0.83 m of it."""
    run, objects = run_with([eye()], [an_object("thing", size, xyz, (1.0, 0.0, 0.0, 1.0))])
    run = pictures(run, objects, every())
    [shot] = run.captures
    seen = int(np.count_nonzero(image(run, "segmentation") == shot.labels["thing"]))
    assert seen / shot.outlines["thing"] == pytest.approx(share, rel=0.1)


def test_noise_is_the_runs_own_and_as_strong_as_the_file_says():
    wall = an_object("wall", (0.1, 9.0, 9.0), (1.0, 0.0, 1.0), (0.5, 0.5, 0.5, 1))
    noisy = eye(noise_mean=0.02, noise_stddev=0.007)

    def shot(seed, *looks, camera=noisy):
        run, objects = run_with([camera], [wall], seed=seed)
        run = pictures(run, objects, *looks)
        return run.files[run.captures[-1].files["color"]], image(run, "color", -1)

    first, picture = shot(1, every())
    assert shot(1, every())[0] == first
    assert shot(1, every(sample=1), every())[0] != first  # another moment
    assert shot(1, every(sample=0), every(sample=1))[0] == shot(1, every(sample=1))[0]
    assert shot(2, every())[0] != first
    _, clean = shot(1, every(), camera=eye())
    difference = picture.astype(float) - clean
    assert difference.mean() == pytest.approx(0.02 * 255, abs=0.05)
    assert difference.std() == pytest.approx(0.007 * 255, rel=0.05)
    assert np.ptp(difference, axis=2).max() == 0, "one value for each pixel, as in Gazebo"


def test_a_grey_camera_has_one_channel():
    run, objects = run_with([eye(is_grey=True)], [ball("ball", (1, 0, 1))])
    assert image(pictures(run, objects, every()), "color").ndim == 2


def test_a_picture_for_an_expectation_is_a_jpeg_of_the_cameras_quality():
    sizes = {}
    for quality in (20, 90):
        run, objects = run_with([eye(jpeg_quality=quality)], [ball("ball", (1, 0, 1), 0.2)])
        run = pictures(run, objects, every(step=""))
        (name,) = [run.captures[0].files["color"]]
        assert name.endswith("look.color.jpg")
        sizes[quality] = len(run.files[name])
    assert sizes[20] < 0.7 * sizes[90]


def test_names_of_cameras_and_steps_make_files_of_their_own_inside_the_folder():
    cameras = [eye(name=name) for name in ("../a b", "../a?b")]
    run, objects = run_with(cameras, [])
    run = pictures(run, objects, *(every(c.name, step="../../x/y") for c in cameras))
    names = list(run.files)
    assert len(names) == len(set(names)) == 2 * 5
    assert all(name.startswith("cameras/") and ".." not in name for name in names)


@pytest.mark.nightly(but=["DICT_7X7_1000-999-egl", "DICT_ARUCO_ORIGINAL-100-rays"])
@pytest.mark.parametrize("backend", ["rays", "egl"])
@pytest.mark.parametrize(
    ("dictionary", "number"),
    [("DICT_4X4_50", 7), ("DICT_5X5_100", 42), ("DICT_6X6_250", 249), ("DICT_7X7_1000", 999),
     ("DICT_ARUCO_ORIGINAL", 100), ("DICT_APRILTAG_36h11", 586)],
)  # fmt: skip
def test_a_marker_is_drawn_so_that_opencv_reads_its_number(backend, dictionary, number):
    camera = eye((0, 0, 1), (0, 0, 0.0), width=320, height=240)
    pose = SE3.from_xyz_rpy((0.03, 0.02, 0.5), (0.3, -0.2, 0.6))
    marker = {"dictionary": dictionary, "id": number, "size": 0.2}
    run, objects = run_with([camera], [card("card", marker, pose)])
    scene = CameraScene(robot(), objects, run.cameras)
    try:
        renderer = make_renderer(scene.picture, camera.width, camera.height, backend)
    except RuntimeError as error:
        pytest.skip(str(error))
    picture = renderer.render(scene.view(camera, scene.pose(run, 0)))
    renderer.close()
    known = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, dictionary))
    corners, ids, _ = cv2.aruco.ArucoDetector(known, cv2.aruco.DetectorParameters()).detectMarkers(
        cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY)
    )
    assert ids is not None
    assert ids.ravel().tolist() == [number]
    # corner 0 is the marker's upper left: -x, +y; then clockwise
    half = 0.1
    for corner, (x, y) in zip(
        corners[0][0], [(-half, half), (half, half), (half, -half), (-half, -half)], strict=True
    ):
        place = pose.apply(np.array([[x, y, 0.0005]]))[0]
        assert np.linalg.norm(corner - predicted(camera, place)) < 2.0
