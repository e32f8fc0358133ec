"""Scenes in which a camera is believed to see what it does not: naive checks against `sees`."""

import cv2
import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.recording.read_run import read_run
from tests.running import run_case

HEAD = """
scenario: {title}
robot: {{model: open_manipulator_x, base: {{xyz: [0, 0, 0.01]}}}}
cameras:
  - {{name: eye, pose: {{xyz: [0.6, 0, 0.3]}}, look_at: {at}, image: {{width: 320, height: 240}}}}
objects:
  - {{name: red_box, static: true, color: [1, 0, 0, 1], in: {who},
     pose: {{xyz: {box}}}, box: {{size: [0.08, 0.08, 0.08]}}}}
  - {{name: wall, static: true, color: [0, 0, 1, 1], pose: {{xyz: {wall}}},
     box: {{size: [0.02, 0.4, 0.4]}}}}
steps:
  - wait: 0.2 s
  - capture: {{camera: {camera}, kinds: [color, segmentation]}}
    id: shot
expect:
"""
PLACES = {"at": "[2, 0, 0.3]", "who": "both", "box": "[1.2, 0, 0.3]", "wall": "[-2, 0, 0.3]",
          "camera": "eye"}  # fmt: skip


def in_range(run):
    """The object stands within the camera's clip distances."""
    eye = run.captures[-1].pose[:3]
    distance = np.linalg.norm(run.signals.object_poses["red_box"][-1, :3] - eye)
    return 0.01 < distance < 15.0


def in_frustum(run):
    """The object's centre projects into the picture."""
    camera = next(each for each in run.cameras if each.name == "eye")
    optical = SE3.from_vector(run.captures[-1].pose)
    centre = optical.inverse().apply(run.signals.object_poses["red_box"][-1:, :3])
    (u, v) = camera.project(centre)[0]
    return 0 <= u < camera.width and 0 <= v < camera.height


def any_red(run):
    """Some pixels are red."""
    content = run.files[run.captures[-1].files["color"]]
    picture = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_COLOR).astype(int)
    return ((picture[..., 2] > 100) & (picture[..., :2].max(axis=2) < 60)).any()


SCENES = {
    "the camera looks the other way": (
        {"at": "[0.6, 5, 0.3]"},
        in_range,
        ["sees: {camera: eye, object: red_box, min_visible: 0.01, min_area: 1}",
         "sees: {camera: eye, color: red, min_area: 1}"],
        ["never: {sees: {camera: eye, object: red_box, min_area: 1, min_visible: 0.001}}"],
    ),
    "the object is in front of the camera, behind a wall": (
        {"wall": "[0.9, 0, 0.3]"},
        in_frustum,
        ["sees: {camera: eye, object: red_box, min_visible: 0.01, min_area: 1}"],
        ["sees: {camera: eye, object: wall, min_visible: 0.3}"],
    ),
    "the object is in the planner's belief alone": (
        {"who": "planning"},
        in_frustum,
        ["sees: {camera: eye, color: red, min_area: 1}"],
        [],
    ),
    "only a corner of the object is in the picture": (
        {"box": "[1.2, 0.355, 0.3]"},
        any_red,
        ["sees: {camera: eye, object: red_box, min_visible: 0.5}"],
        ["sees: {camera: eye, object: red_box, min_visible: 0.01}"],
    ),
    "the red is the robot's own": (
        {"camera": "gripper_camera", "box": "[-1, 0, 0.3]"},
        any_red,
        ["sees: {camera: gripper_camera, object: red_box, min_visible: 0.01, min_area: 1}"],
        ["sees: {camera: gripper_camera, color: red}"],
    ),
}  # fmt: skip


@pytest.mark.nightly(but=[1, 2])
@pytest.mark.parametrize("title", SCENES)
def test_the_naive_check_is_fooled_and_sees_is_not(title, tmp_path):
    changes, naive, refuted, kept = SCENES[title]
    text = HEAD.format(title=title, **{**PLACES, **changes})
    path = tmp_path / "scene.scenario.yaml"
    path.write_text(text + "".join(f"  - {each}\n" for each in (*refuted, *kept)))
    result = run_case(path, report_dir=tmp_path / "report", stills=False, page=False)
    assert result.verdicts, (result.problems, result.message)
    assert naive(read_run(tmp_path / "report").run), "the naive check would not be fooled"
    statuses = [verdict.status for verdict in result.verdicts]
    assert statuses == ["failed"] * len(refuted) + ["passed"] * len(kept), result.verdicts
