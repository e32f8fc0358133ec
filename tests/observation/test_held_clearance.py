"""Distances of what the hand holds or carries, whether or not a step attached it."""

import numpy as np
import pytest

from harness.recording.read_run import read_run
from tests.adversarial.carried_scenes import CARRIED_SCENES
from tests.adversarial.table import run_scene


@pytest.fixture(scope="module")
def carried(tmp_path_factory):
    folder = tmp_path_factory.mktemp("carried")
    scene = next(each for each in CARRIED_SCENES if each.title.startswith("load on a held tray"))
    run_scene(scene, folder)
    return read_run(folder / "report").run


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
