"""The camera scenarios from file to folder, and their folders judged where nothing can draw."""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from harness.core.pose_arrays import compose
from harness.core.resources import data_folder
from harness.recording.film import decoded_film
from harness.recording.link_poses import replayed_link_poses
from harness.recording.plain import to_plain
from harness.recording.read_run import read_run
from tests.running import run_case

FOLDER = data_folder("scenarios") / "cameras"
GRIPPER = FOLDER / "01_gripper_camera.scenario.yaml"
MARKERS = FOLDER / "02_cameras_and_markers.scenario.yaml"
JUDGE_WITHOUT_A_RENDERER = """
import json, sys
from pathlib import Path
for name in ("mujoco", "ompl", "pinocchio", "coal", "OpenGL"):
    sys.modules[name] = None
from harness.recording.plain import to_plain
from harness.recording.read_run import read_run
from harness.plugins.comparison.rejudge import judge_stored
folder = Path(sys.argv[1])
print(json.dumps(to_plain(judge_stored(read_run(folder), folder))))
"""


@pytest.fixture(scope="module", params=[GRIPPER, MARKERS], ids=["gripper", "markers"])
def case(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("cameras") / "run"
    result = run_case(request.param, report_dir=folder, stills=False, page=False)
    return result, folder, read_run(folder).run


@pytest.mark.nightly
def test_it_passes_and_its_record_is_judged_alike_where_nothing_can_draw(case):
    result, folder, _ = case
    assert result.outcome == "passed", (result.message, result.verdicts)
    done = subprocess.run(
        [sys.executable, "-c", JUDGE_WITHOUT_A_RENDERER, str(folder)],
        capture_output=True,
        text=True,
        check=True,
    )
    # the saved file has lines of its own
    expected = [to_plain(replace(verdict, line=0)) for verdict in result.verdicts]
    assert [{**verdict, "line": 0} for verdict in json.loads(done.stdout)] == expected


@pytest.mark.nightly
def test_the_report_names_who_drew_each_picture(case):
    _, folder, _ = case
    document = json.loads((folder / "run.json").read_text())
    assert {shot["backend"] for shot in document["captures"]} == {"rays"}
    assert {film["backend"] for film in document["videos"]} <= {"egl", "osmesa", "rays"}


@pytest.mark.nightly
def test_every_capture_is_a_sample_of_its_step_and_stands_where_the_robot_was(case):
    _, _, run = case
    steps = {step.id: step for step in run.steps}
    cameras = {camera.name: camera for camera in run.cameras}
    shots = [shot for shot in run.captures if shot.step]
    assert [shot.step for shot in shots] == [s.id for s in run.steps if s.verb == "capture"]
    poses = replayed_link_poses(run.robot, run.signals.joint_positions)
    for shot in run.captures:
        assert run.signals.times[shot.sample] == shot.time
        if shot.step:
            assert shot.sample == steps[shot.step].end_index - 1
            # cameras take their pictures at multiples of their period, physics in steps of 1 ms
            beats = shot.time * cameras[shot.camera].update_rate
            assert abs(beats - round(beats)) < 0.021
        camera = cameras[shot.camera]
        carrier = {**poses, **run.signals.object_poses, "world": poses["world"]}[camera.frame]
        row = carrier[min(shot.sample, len(carrier) - 1)][None]
        expected = compose(row, camera.optical_pose.as_vector())[0]
        np.testing.assert_allclose(shot.pose[:3], expected[:3], atol=1e-9)
        assert abs(np.dot(shot.pose[3:], expected[3:])) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.nightly
def test_pictures_change_no_sample_of_the_physics(tmp_path):
    text = MARKERS.read_text().split("  - ptp:")[0]
    signals = []
    for number, kinds in enumerate(("color, depth, segmentation", "depth")):
        path = tmp_path / f"{number}.scenario.yaml"
        path.write_text(text.replace("color, depth, segmentation", kinds))
        folder = tmp_path / str(number)
        run_case(path, report_dir=folder, stills=False, page=False)
        signals.append(read_run(folder).run.signals)
    np.testing.assert_array_equal(signals[0].joint_positions, signals[1].joint_positions)
    for name, rows in signals[0].object_poses.items():
        np.testing.assert_array_equal(rows, signals[1].object_poses[name])


@pytest.mark.nightly
def test_a_video_has_a_time_for_every_frame_within_the_run(case):
    _, folder, run = case
    drawings = read_run(folder).drawings
    for film in drawings.videos:
        assert film.times[0] == 0.0
        assert film.times[-1] <= run.signals.times[-1] + 1e-9
        frames = list(decoded_film(drawings.files[film.file]))
        assert len(frames) == len(film.times)
        camera = next(camera for camera in run.cameras if camera.name == film.camera)
        assert frames[0].shape == (camera.height, camera.width, 3)


@pytest.mark.nightly
def test_a_run_of_a_camera_is_the_same_twice_to_the_byte(tmp_path):
    text = GRIPPER.read_text().split("  - lin:")[0].replace("rate: 5 Hz", "rate: 2 Hz")
    path = tmp_path / "short.scenario.yaml"
    path.write_text(text)
    runs = []
    for number in range(2):
        run_case(path, report_dir=tmp_path / str(number), stills=False, page=False)
        runs.append(read_run(tmp_path / str(number)).run)
    first, second = (dict(run.files) for run in runs)
    assert first == second
    assert len(first) > 8
    assert to_plain(replace(runs[0], files={}).captures) == to_plain(runs[1].captures)
