"""Distances of what the hand holds or carries, whether or not a step attached it."""

import numpy as np
import pytest

from harness.recording.read_run import read_run
from tests.adversarial.carried_scenes import CARRIED_SCENES
from tests.adversarial.table import run_scene
from tests.session.front_door import failures, run


@pytest.fixture(scope="module")
def carried(tmp_path_factory):
    folder = tmp_path_factory.mktemp("carried")
    scene = next(each for each in CARRIED_SCENES if each.title.startswith("load on a held tray"))
    run_scene(scene, folder)
    return read_run(folder / "report").run


@pytest.mark.nightly
def test_distances_of_what_is_carried_are_those_of_its_shapes_while_the_hand_carries_it(carried):
    """A cube of 4 cm and a beam whose face is at x = 0.25 m, both along the axes."""
    measured = carried.signals.clearances["cup", "beam"]
    known = np.isfinite(measured)
    x, z = carried.signals.object_poses["cup"][:, [0, 2]].T
    next_to_beam = known & (z > 0.2) & (measured < carried.signals.clearance_cutoff)
    assert next_to_beam.sum() > 100
    assert measured[next_to_beam] == pytest.approx(0.25 - 0.02 - x[next_to_beam], abs=2e-4)
    assert not known[:1000].any(), "the hand is open"


def test_no_distance_is_recorded_of_what_the_hand_never_carries(carried):
    assert not [key for key in carried.signals.clearances if key[0] in ("beam", "ground_plane")]


ARM = "{model: open_manipulator_x, base: {xyz: [0, 0, 0.01]}}"
BOX = """
objects:
  - {name: red_box, box: {size: [0.03, 0.03, 0.08]}, mass: 0.05, pose: {xyz: [%s, 0, 0.04]}}
expect:
  - {clearance: {between: [robot, any], at_least: 1 mm}, during: swing}
"""
SWING = """
- attach_object: red_box
- ptp: {joints: {joint1: %s}}
  id: swing
"""
TAKE = """
- gripper: open
- move_to: {position: {xyz: [0.2, 0, 0.06]}, pitch: 0}
- lin: {position: {xyz: [0.25, 0, 0.06]}, pitch: 0}
"""


@pytest.mark.nightly(but=["steps2-0.25-failed"])
@pytest.mark.parametrize(("steps", "x", "status"), [
    ("- move_to: {position: {xyz: [0.18, -0.2, 0.06]}, pitch: 0}" + SWING % 0.5, 0.26, "failed"),
    ("- move_to: {joints: {joint1: -0.8, joint2: -0.9}}" + SWING % 0.5, 0.3, "passed"),
    (TAKE + SWING % 0.4, 0.25, "failed"),
    (TAKE + "- grasp: red_box" + SWING.replace("- attach_object: red_box", "") % 0.4, 0.25,
     "passed"),
])  # fmt: skip
def test_what_is_attached_in_the_planning_scene_alone_has_a_distance(tmp_path, steps, x, status):
    """The arm swings into the box, or past it; open fingers knock it over; a grasp takes it."""
    result, _ = run(tmp_path, steps, robot=ARM, rest=BOX % x)
    assert [verdict.status for verdict in result.verdicts] == [status], failures(result)


@pytest.mark.nightly
def test_an_object_that_the_hand_lets_go_of_and_stays_attached_has_a_distance_again(tmp_path):
    steps = (
        TAKE
        + """
- grasp: red_box
- gripper: open
- lin: {position: {xyz: [0.2, 0, 0.06]}, pitch: 0}
  id: swing
"""
    )
    _, record = run(tmp_path, steps, robot=ARM, rest=BOX % 0.25)
    distance = record.signals.clearances["robot", "red_box"]
    grasp, opening = (next(each for each in record.steps if each.id == name)
                      for name in ("steps[3]", "steps[4]"))  # fmt: skip
    assert np.isnan(distance[grasp.end_index : opening.end_index]).all()
    assert np.isfinite(distance[opening.end_index :]).all()
    assert record.attachments[0].end_time == np.inf
