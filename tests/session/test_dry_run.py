"""What the adapters without physics answer: commands come true, contacts happen as hoped."""

from types import SimpleNamespace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.core.trajectory import JointTrajectory
from harness.ports.simulation import ExpectedGrasp
from harness.session.dry_run import DrySimulator

GRIPPER = SimpleNamespace(
    joint="finger", open_position=0.03, closed_position=0.0, sides={"left": (), "right": ()}
)


def thing(name, *, static=False, simulated=True):
    return SimpleNamespace(
        name=name, is_static=static, in_simulation=simulated, pose=name, surface_motion=None
    )


class Hand:
    """A robot of a joint, a gripper, and a finger that follows it twice as far."""

    joint_index = {"arm": 0, "finger": 1, "mimic": 2}  # noqa: RUF012

    def __init__(self, gripper=GRIPPER):
        self.grippers = (gripper,) if gripper else ()

    def start_positions(self):
        return np.array([0.1, 0.02, 0.04])

    def with_mimics(self, positions):
        return np.array([positions[0], positions[1], 2 * positions[1]])


def simulator(**changes):
    objects = [thing("box"), thing("table", static=True), thing("belief", simulated=False)]
    gripper = SimpleNamespace(**{**vars(GRIPPER), **changes})
    program = SimpleNamespace(
        description=Hand(gripper if gripper.joint else None),
        world=SimpleNamespace(objects=objects[:1]),
        all_objects=lambda: objects,
    )
    return DrySimulator(program, SimpleNamespace(attached=dict))


@pytest.mark.parametrize(
    ("span", "position", "touches"),
    [
        ((0.03, 0.0), 0.019, True),
        ((0.03, 0.0), 0.02, False),
        ((0.03, 0.0), 0.021, False),
        ((0.0, 0.03), 0.021, True),
        ((0.0, 0.03), 0.019, False),
    ],
)
def test_fingers_that_close_touch_whatever_may_move(span, position, touches):
    hand = simulator(open_position=span[0], closed_position=span[1])
    answer = hand.command_gripper(position, 5.0, timeout=1.0)
    found = ("box",) if touches else ()
    assert answer.between == found
    assert answer.contacts == {"left": found, "right": found}
    assert (answer.position, answer.effort) == (position, 0.0)
    assert (answer.stalled, answer.reached_goal) == (False, True)
    expected = [0.1, position, 2 * position]
    assert hand.joint_positions().tolist() == hand.commanded_positions().tolist() == expected


def test_fingers_miss_in_a_step_that_is_expected_to_fail():
    hand = simulator()
    fails = SimpleNamespace(path="steps[1]", spec=SimpleNamespace(expect_error="CONTROL_FAILED"))
    other = SimpleNamespace(path="steps[2]", spec=SimpleNamespace(expect_error=None))
    hand.watch(fails, None)
    hand.watch(other, None)
    assert hand.command_gripper(0.01, 5.0, timeout=1.0).between == ()
    hand.watch(other, object())
    hand.watch(fails, object())
    assert hand.command_gripper(0.0, 5.0, timeout=1.0).between == ("box",)
    with pytest.raises(RuntimeError, match="no gripper"):
        simulator(joint="").command_gripper(0.0, 5.0, timeout=1.0)


def test_a_trajectory_ends_where_it_should_and_mimics_follow():
    hand = simulator()
    rows = np.array([[0.0, 0.0], [0.01, 0.7]])
    zero = np.zeros((2, 2))
    hand.track(JointTrajectory(("finger", "arm"), np.array([0.0, 1.0]), rows, zero, zero))
    assert hand.joint_positions().tolist() == [0.7, 0.01, 0.02]
    assert (hand.time, hand.sample_count, hand.settle(0.1, 1.0)) == (0.0, 1, True)


def test_objects_stand_where_they_are_put():
    hand = simulator()
    assert hand.object_pose("box") == "box"
    for put in (hand.add_object, hand.move_object):
        pose = SE3.identity()
        put("cup", pose)
        assert hand.object_pose("cup") is pose
    hand.remove_object("cup")
    hand.remove_object("cup")
    with pytest.raises(KeyError):
        hand.object_pose("cup")


@pytest.mark.parametrize(
    ("expected", "is_free", "end"),
    [(0.012, True, 0.012), (0.012, False, 0.012), (0.05, True, 0.02)],
)
def test_fingers_end_where_they_are_expected_to_meet_an_object(expected, is_free, end):
    """A hand that is closed farther than the object's width stays where it is."""
    hand = simulator(open_position=0.03, closed_position=0.0)
    answer = hand.command_gripper(0.0, 5.0, timeout=1.0, expected=ExpectedGrasp(expected, is_free))
    assert answer.position == end
    assert answer.between == (("box",) if is_free else ())
