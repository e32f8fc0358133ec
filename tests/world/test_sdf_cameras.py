"""Camera sensors of SDF worlds: they see what stands in front of them."""

import cv2
import numpy as np
import pytest

from harness.core.errors import SpecError
from tests.running import run_case
from tests.world.sdf_files import load, text_with

WORLD = """<?xml version="1.0"?>
<sdf version="1.9">
 <world name="watched">
  <model name="ball"><static>true</static><pose>0.5 0.2 0.3 0 0 0</pose><link name="l">
   <collision name="c"><geometry><sphere><radius>0.05</radius></sphere></geometry></collision>
   <visual name="v"><geometry><sphere><radius>0.05</radius></sphere></geometry>
    <material><diffuse>1 0 0 1</diffuse></material></visual></link></model>
  <model name="post"><static>true</static><pose>0.5 1.2 0.3 0 0 -1.5707963267948966</pose>
   <link name="l"><visual name="v"><geometry><box><size>0.02 0.02 0.02</size></box></geometry>
    </visual>
    <sensor name="watcher" type="camera"><pose>0.05 0 0 0 0 0</pose>
     <update_rate>10</update_rate><always_on>1</always_on>
     <camera><horizontal_fov>0.5</horizontal_fov>
      <image><width>64</width><height>48</height><format>R8G8B8</format></image>
      <clip><near>0.05</near><far>5</far></clip></camera></sensor></link></model>
 </world>
</sdf>
"""


def test_a_camera_of_the_world_is_captured_and_sees_the_ball(tmp_path):
    (tmp_path / "watched.sdf").write_text(WORLD)
    path = tmp_path / "look.scenario.yaml"
    path.write_text(
        "scenario: look\nrobot: {gripper: rh_p12_rn_a, base: {xyz: [-2, -2, 1]}}\n"
        "world: watched.sdf\nsteps:\n  - capture: watcher\n"
        "expect:\n  - sees: {camera: watcher, object: ball}\n"
    )
    result = run_case(path, report_dir=tmp_path / "report", stills=False, page=False)
    assert result.outcome == "passed", result
    [file] = (tmp_path / "report/cameras/watcher").glob("*.color.png")
    picture = cv2.imread(str(file)).astype(int)
    assert picture.shape == (48, 64, 3)
    blue, _, red = np.moveaxis(picture, 2, 0)
    rows, columns = np.nonzero(red - blue > 60)
    # 0.95 m away, straight ahead: radius 0.05 m is 0.0526 of 0.2553 half widths, or 6.6 pixels
    assert rows.mean() == pytest.approx(23.5, abs=1)
    assert columns.mean() == pytest.approx(31.5, abs=1)
    assert np.ptp(columns) + 1 == pytest.approx(2 * 6.6, abs=2)


def test_cameras_called_alike_are_named_after_their_models(tmp_path):
    other = "<sensor name='eye' type='depth_camera'/>"
    model = f"<model name='n'><static>1</static><link name='l'>{other}</link></model>"
    world = load(tmp_path, text_with("world", model)).world
    assert [camera.name for camera in world.cameras] == ["n::eye", "m::eye"]
    assert world.cameras[0].pose.frame == "world"  # nothing of that model is left but its camera


def test_a_format_without_a_meaning_and_other_sensors_are_reported(tmp_path):
    found = load(tmp_path, text_with("image", "<format>BAYER_RGGB8</format>"))
    assert any("BAYER_RGGB8 is taken as R8G8B8" in note.message for note in found.notes)
    found = load(tmp_path, text_with("link", "<sensor name='l' type='gpu_lidar'/>"))
    assert [camera.name for camera in found.world.cameras] == ["eye"]
    assert any("of the type 'gpu_lidar' is left out" in note.message for note in found.notes)


@pytest.mark.parametrize(
    ("kind", "snippet", "message"),
    [
        ("camera", "\n<horizontal_fov>3.2</horizontal_fov>", "a field of view of 3.2 rad"),
        ("image", "\n<width>9000</width>", "width is 8 to 2048 pixels, not 9000"),
        ("image", "\n<width>wide</width>", "expected a finite number"),
        ("clip", "\n<near>10</near>", "<near> (10 m) is above 0 and less than <far> (9 m)"),
        ("noise", "\n<stddev>7</stddev>", "a share of full white"),
        ("noise", "\n<type>perlin</type>", "the noise type `perlin` is not known"),
    ],
)
def test_a_number_that_no_camera_has_is_reported_at_its_place(tmp_path, kind, snippet, message):
    text = text_with(kind, snippet)
    with pytest.raises(SpecError) as caught:
        load(tmp_path, text)
    (problem,) = caught.value.problems
    assert message in problem.message
    line = next(number for number, row in enumerate(text.splitlines(), 1) if snippet[1:] in row)
    assert line - 1 <= problem.line <= line
