"""Which mimic joint is reported to have left the joint it follows."""

from types import SimpleNamespace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.plugins.remarks.observers.couplings import coupling_findings
from harness.robot.mechanism import Joint, Mimic
from tests.judging.synthetic_run import changed, make_run

N = 10


def joint(name, kind, follows=None, multiplier=1.0, offset=0.0):
    mimic = Mimic(follows, multiplier, offset) if follows else None
    return Joint(name, kind, "hand", name, SE3.identity(), np.array([1.0, 0, 0]), mimic=mimic)


JOINTS = (
    joint("lead", "prismatic"),
    joint("slide", "prismatic", "lead", -2.0, 0.1),
    joint("turn", "revolute", "lead"),
)
HAND = SimpleNamespace(
    movable_joints=JOINTS,
    joint_index={each.name: column for column, each in enumerate(JOINTS)},
    joint_by_name={each.name: each for each in JOINTS},
)


def findings(slide=0.0, turn=0.0, at=4):
    positions = np.tile((0.02, 0.06, 0.02), (N, 1))
    positions[at, 1] += slide
    positions[at, 2] += turn
    return coupling_findings(changed(make_run(N), joint_positions=positions).signals, HAND)


@pytest.mark.parametrize("sign", [1, -1])
def test_the_joint_that_is_furthest_off_by_its_own_limit_is_reported(sign):
    """Limits: 1 mm of a prismatic joint, 0.02 rad of a revolute one."""
    assert findings() == findings(0.99e-3 * sign) == findings(0, 0.0199 * sign) == ()
    for slide, turn, name, error, unit in (
        (1.01e-3, 0, "slide", 1.01e-3, "m"),
        (0, 0.0201, "turn", 0.0201, "rad"),
        (2e-3, 0.03, "slide", 2e-3, "m"),
        (2e-3, 0.05, "turn", 0.05, "rad"),
    ):
        [found] = findings(sign * slide, sign * turn)
        assert found.values == {"joint": name, "error": pytest.approx(error), "unit": unit}
        assert found.time == pytest.approx(0.04)
        assert found.message.startswith(f"{name} was ")
    assert findings(2e-3 * sign, at=0)[0].time == 0.0


def test_positions_that_are_missing_or_were_never_recorded_are_no_finding():
    assert findings(slide=np.nan) == ()
    assert coupling_findings(make_run(0).signals, HAND) == ()
