"""Links that touch at random configurations, as `harness robot check` counts them."""

import numpy as np

from harness.planning.collision.scene import CoalScene
from harness.plugins.authoring.pair_statistics import self_touches
from harness.robot.random_positions import sample_robot_positions
from tests.robot.arm_files import SRDF, load_arm, write_arm
from tests.robot.hands import SIX

ROLLER = (
    '<collision><origin rpy="1.2 0 0"/><geometry><cylinder radius="0.05" length="0.3"/></geometry>'
    "</collision>"
)


def test_a_configuration_is_free_where_no_distance_of_the_planner_says_otherwise(tmp_path):
    """Coal's guess from the configuration before would overlook deep contacts of cylinders."""
    urdf = SIX
    for link in ("a", "b", "c", "d", "e"):
        urdf = urdf.replace(f'<link name="{link}">', f'<link name="{link}">{ROLLER}')
    write_arm(tmp_path, urdf, SRDF)
    arm = load_arm(tmp_path, srdf=None)
    rows = sample_robot_positions(arm, 200, np.random.default_rng(0))
    scene = CoalScene(arm)
    expected = [not scene.touches(row) for row in rows]
    assert 20 < sum(expected) < 180
    assert self_touches(arm, rows).is_free.tolist() == expected
