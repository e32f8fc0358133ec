"""A recorded camera's video: its size, its clock, and what it shows."""

import subprocess
import sys
from dataclasses import replace

import cv2
import numpy as np
import pytest

from harness.core.camera import MOST_FRAMES
from harness.plugins.cameras.camera_scene import CameraScene
from harness.plugins.cameras.observers.videos import slowed_videos
from harness.plugins.cameras.renderer import make_renderer
from harness.plugins.cameras.sensor import as_delivered
from harness.plugins.cameras.videos import record_videos
from harness.recording.film import decoded_film
from tests.cameras.camera_runs import ball, eye, robot, run_with
from tests.cameras.test_captures import centre_of, predicted
from tests.waiting import HANG

CAMERA = eye(width=200, height=150, update_rate=10.0, jpeg_quality=75)


def crossing(n=101):
    """A ball that crosses the picture in one second."""
    thing = ball("ball", (0.8, 0.0, 1.0), 0.08)
    rows = np.tile(thing.pose.as_vector(), (n, 1))
    rows[:, 1] = np.linspace(-0.3, 0.3, n)
    return run_with([CAMERA], [thing], n=n, poses={"ball": rows})


def recorded(run, objects, rate=10.0, backend="rays"):
    (video,), files = record_videos(robot(), objects, run, {"eye": rate}, backend=backend)
    return video, files


def film_of(content, folder):
    path = folder / "film.webm"
    path.write_bytes(content)
    reader, frames = cv2.VideoCapture(str(path)), []
    while True:
        is_there, frame = reader.read()
        if not is_there:
            return frames
        frames.append(frame)


def red_in(picture):
    blue, green, red = (picture[:, :, i].astype(int) for i in range(3))
    return (red > 90) & (red > 2 * np.maximum(blue, green))


@pytest.mark.nightly(but=["egl"])
@pytest.mark.parametrize("backend", ["rays", "egl"])
def test_every_frame_shows_the_moment_that_the_clock_table_says(tmp_path, backend):
    run, objects = crossing()
    try:
        video, files = recorded(run, objects, backend=backend)
    except RuntimeError as error:
        pytest.skip(str(error))
    assert (video.backend, video.rate) == (backend, 10.0)
    np.testing.assert_allclose(video.times, np.arange(11) / 10)
    film = film_of(files[video.file], tmp_path)
    assert len(film) == len(video.times)
    assert film[0].shape == (video.height, video.width, 3) == (150, 200, 3)
    assert list(files) == [video.file]
    for number, time in enumerate(video.times):
        place = (0.8, -0.3 + 0.6 * time, 1.0)
        column = predicted(CAMERA, place)[0]
        assert abs(centre_of(red_in(film[number]))[0] - column) < 2


@pytest.mark.nightly(only=["1280-720"])
@pytest.mark.parametrize(("width", "height"), [(1280, 720), (321, 241), (64, 48), (8, 8)])
def test_a_video_has_the_camera_s_size_in_even_numbers(width, height, tmp_path):
    run, objects = crossing(2)
    run = replace(run, cameras=(replace(CAMERA, width=width, height=height),))
    video, files = recorded(run, objects)
    (frame,) = film_of(files[video.file], tmp_path)
    assert frame.shape[1::-1] == (video.width, video.height)
    assert abs(video.width - width) <= 1
    assert abs(video.height - height) <= 1
    assert video.width % 2 == video.height % 2 == 0


@pytest.mark.nightly(but=["0.02"])
@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_a_video_shows_what_the_camera_delivered(noise):
    run, objects = crossing(2)
    camera = replace(CAMERA, width=320, height=240, noise_stddev=noise)
    run = replace(run, cameras=(camera,))
    video, files = recorded(run, objects)
    shown = next(decoded_film(files[video.file]))
    scene = CameraScene(robot(), objects, run.cameras)
    renderer = make_renderer(scene.picture, camera.width, camera.height, "rays")
    drawn = renderer.render(scene.view(camera, scene.pose(run, 0)))
    renderer.close()
    assert cv2.PSNR(as_delivered(drawn, camera, run.seed, 0), np.ascontiguousarray(shown)) > 33


@pytest.mark.nightly
def test_a_long_run_is_recorded_more_slowly_and_says_so():
    run, objects = run_with([CAMERA], [], n=2)
    times = np.array([0.0, 2 * MOST_FRAMES / 10.0])
    run = replace(run, signals=replace(run.signals, times=times))
    tiny = replace(CAMERA, width=16, height=16)
    run = replace(run, cameras=(tiny,))
    video, _ = recorded(run, objects)
    (note,) = slowed_videos(run, {"eye": 10.0})
    assert len(video.times) <= MOST_FRAMES + 1
    assert note.message == (
        "eye is recorded at 5 Hz instead of 10 Hz: a video of this size has at most 1500 frames"
    )


@pytest.mark.parametrize(
    ("width", "height", "counted"), [(1280, 720, 1.0), (720, 1280, 1.0), (1920, 1080, 2.25)]
)
def test_pictures_beyond_hd_count_by_their_pixels(width, height, counted):
    assert replace(CAMERA, width=width, height=height).pictures_counted == counted


@pytest.mark.nightly
def test_videos_of_equal_runs_are_equal_bytes():
    run, objects = crossing(21)
    run = replace(run, cameras=(replace(CAMERA, noise_stddev=0.01),))
    assert recorded(run, objects)[1] == recorded(run, objects)[1]


@pytest.mark.nightly
def test_nothing_of_the_video_library_reaches_the_terminal():
    code = (
        "from tests.cameras.test_videos import crossing, recorded\n"
        "recorded(*crossing(11))\nprint('done')"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=HANG
    )
    assert (done.stdout, done.stderr) == ("done\n", "")
