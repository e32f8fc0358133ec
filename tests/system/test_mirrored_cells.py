"""A cell and its mirror image, with the arms' names exchanged, have the same verdicts.

The OpenMANIPULATOR-X is its own mirror image in the plane of its arm. Planner, physics and
judging are none of them mirrored: what differs is rounding, the order of links in a search, and the
pad that closes first. Margins may differ by 1 mm, 1 mrad, 1 % or 2 N.
"""

import pytest

from harness.recording.read_run import read_run

ALLOWED = {"m": 1e-3, "rad": 1e-3, "N": 2.0}
SHARE = 0.01
CELL = """
scenario: one arm picks and the other one comes near
robots:
  {near}: {{model: open_manipulator_x, base: {{xyz: [0, {y}, 0]}}}}
  {far}: {{model: open_manipulator_x, base: {{xyz: [0, {minus_y}, 0]}}}}
objects:
  - name: can
    cylinder: {{radius: 15 mm, length: 6 cm}}
    mass: 0.05
    pose: {{xyz: [0.22, {y}, 0.03]}}
steps:
  - gripper: open
    robot: {near}
  - ptp: {{position: [0.22, {y}, 0.1], pitch: 60 deg}}
    robot: {near}
  - lin: {{position: [0.22, {y}, 0.035], pitch: 60 deg}}
    robot: {near}
  - grasp: can
    robot: {near}
  - lin: {{position: [0.22, {y}, 0.12], pitch: 60 deg}}
    robot: {near}
  - ptp: {{joints: {{{near}_joint1: {turn}}}}}
    robot: {near}
  - ptp: {{joints: {{{far}_joint1: {back}}}}}
    robot: {far}
expect:
  - grasped: {{object: can, by: {near}}}
  - lifted: {{object: can, by: {near}}}
  - grasped: {{object: can, by: {far}}}
  - clearance: {{between: [{near}, {far}], at_least: {apart}}}
  - clearance: {{between: [can, {far}], at_least: 1 cm}}
  - never: collision
  - within_limits
  - tcp_pose:
      by: {near}
      pose: {{xyz: [0.2, {inner}, 0.12]}}
      position_only: true
      tolerance: {{position: 3 cm}}
"""


def cell(side, apart):
    """The cell with the arm that picks at y of a sign."""
    names = ("left", "right") if side > 0 else ("right", "left")
    return CELL.format(
        near=names[0], far=names[1], y=0.17 * side, minus_y=-0.17 * side, turn=-0.35 * side,
        back=0.3 * side, inner=0.1 * side, apart=apart,
    )  # fmt: skip


@pytest.mark.parametrize("apart", ["2 cm", pytest.param("30 cm", marks=pytest.mark.nightly)])
def test_verdicts_and_margins_are_mirrored(apart, recorded_run):
    both = [
        read_run(recorded_run(cell(side, apart), "failed") / "run").verdicts for side in (1, -1)
    ]
    assert len({verdict.status for verdict in both[0]}) > 1
    for one, other in zip(*both, strict=True):
        assert one.status == other.status, (one, other)
        if one.margin is not None:
            allowed = max(ALLOWED.get(one.unit, 0.0), SHARE * abs(one.margin))
            assert one.margin == pytest.approx(other.margin, abs=allowed), (one, other)
