"""A cell, its mirror image, a shifted one and one with other names have the same verdicts.

The OpenMANIPULATOR-X is its own mirror image in the plane of its arm. Planner, physics and
judging are none of them mirrored: what differs is rounding, the order of links in a search, and the
pad that closes first. Margins may differ by 1 mm, 1 mrad, 1 % or 2 N. In the mirror image the arms
exchange their names and their order, too.
"""

import pytest

from harness.recording.read_run import read_run

ALLOWED = {"m": 1e-3, "rad": 1e-3, "N": 2.0}
SHARE = 0.01
CELL = """
scenario: one arm picks and the other one comes near
robots:
  {near}: {{model: open_manipulator_x, base: {{xyz: [{x0}, {y}, 0]}}}}
  {far}: {{model: open_manipulator_x, base: {{xyz: [{x0}, {other_y}, 0]}}}}
objects:
  - name: can
    cylinder: {{radius: 15 mm, length: 6 cm}}
    mass: 0.05
    pose: {{xyz: [{x}, {y}, 0.03]}}
steps:
  - gripper: open
    robot: {near}
  - ptp: {{position: [{x}, {y}, 0.1], pitch: 60 deg}}
    robot: {near}
  - lin: {{position: [{x}, {y}, 0.035], pitch: 60 deg}}
    robot: {near}
  - grasp: can
    robot: {near}
  - lin: {{position: [{x}, {y}, 0.12], pitch: 60 deg}}
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
      pose: {{xyz: [{inner_x}, {inner}, 0.12]}}
      position_only: true
      tolerance: {{position: 3 cm}}
"""


def cell(side, apart, names=("left", "right"), shift=(0.0, 0.0)):
    """The cell with the arm that picks at y of a sign, all of it moved by a shift [m]."""
    names, (x, y) = names[::side], shift
    return CELL.format(
        near=names[0], far=names[1], x0=x, x=0.22 + x, y=0.17 * side + y, other_y=-0.17 * side + y,
        turn=-0.35 * side, back=0.3 * side, inner_x=0.2 + x, inner=0.1 * side + y, apart=apart,
    )  # fmt: skip


CHANGED = {
    "mirrored": {"side": -1},
    "shifted": {"side": 1, "shift": (0.75, -1.5)},
    "shifted far": {"side": 1, "shift": (-4.1, 2.3)},
    "names exchanged": {"side": 1, "names": ("right", "left")},
    "other names": {"side": 1, "names": ("zeta", "alpha")},
}


@pytest.mark.nightly(but=["shifted-2 cm"])
@pytest.mark.parametrize("apart", ["2 cm", "30 cm"])
@pytest.mark.parametrize("change", CHANGED)
def test_verdicts_and_margins_stay(change, apart, recorded_run):
    texts = cell(1, apart), cell(apart=apart, **CHANGED[change])
    both = [read_run(recorded_run(text, "failed") / "run").verdicts for text in texts]
    assert len({verdict.status for verdict in both[0]}) > 1
    for one, other in zip(*both, strict=True):
        assert one.status == other.status, (one, other)
        if one.margin is not None:
            allowed = max(ALLOWED.get(one.unit, 0.0), SHARE * abs(one.margin))
            assert one.margin == pytest.approx(other.margin, abs=allowed), (one, other)
