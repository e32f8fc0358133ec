"""within_limits: joints stay within their limits."""

import re
from dataclasses import replace

import numpy as np
import pytest

from harness.judging.expectations.within_limits import WithinLimits
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Free, Three
from tests.judging.synthetic_run import ROBOT, changed, make_run, verdict


def positions(shoulder, finger=0.0):
    return np.tile([shoulder, finger], (200, 1))


def test_limits_are_inclusive_and_the_worst_joint_is_reported():
    at_limit = make_run(
        joint_positions=positions(1.0), joint_efforts=positions(10.0), joint_velocities=positions(2)
    )
    assert verdict(at_limit, WithinLimits()).status == "passed"
    for change, said in (
        ({"joint_positions": positions(-1.0011)}, "position of shoulder"),
        ({"joint_velocities": positions(-2.0051)}, "velocity of shoulder"),
        ({"joint_efforts": positions(0.0, 20.1)}, "effort of finger"),
    ):
        answer = verdict(make_run(**change), WithinLimits())
        assert answer.status == "failed"
        assert answer.reason.startswith(said)
    beyond = make_run(joint_velocities=positions(2.1))
    assert verdict(beyond, WithinLimits(velocity=False)).status == "passed"
    assert verdict(beyond, WithinLimits(during="later")).status == "not reached"


def test_a_gripper_may_rest_on_its_stop_and_an_arm_may_not():
    assert (
        verdict(make_run(joint_positions=positions(0, -0.0005)), WithinLimits()).status == "passed"
    )
    assert (
        verdict(make_run(joint_positions=positions(0, -0.0007)), WithinLimits()).status == "failed"
    )
    assert verdict(make_run(joint_positions=positions(1.0011)), WithinLimits()).status == "failed"


def test_an_idle_joint_off_the_arm_may_rest_on_its_stop_too():
    run = make_run(joint_positions=positions(0, -0.0005))
    bare = replace(run, robot=replace(run.robot, gripper=None))
    assert verdict(bare, WithinLimits()).status == "passed"
    commands = positions(0.0)
    commands[100:, 1] = 0.01
    driven = changed(bare, joint_commands=commands)
    assert verdict(driven, WithinLimits()).status == "failed"


def test_acceleration_is_that_of_the_commands():
    velocities = positions(0.0)
    velocities[100:, 0] = 0.051  # in one sample: 5.1 rad/s^2
    run = make_run(joint_command_velocities=velocities)
    assert verdict(run, WithinLimits()).status == "passed"
    answer = verdict(run, WithinLimits(acceleration=True))
    assert answer.status == "failed"
    assert answer.margin == pytest.approx(-0.1)
    assert answer.time == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("beyond", "status"), [(0.0, "passed"), (1e-7, "passed"), (9e-4, "passed"), (1.1e-3, "failed")]
)
def test_a_measured_position_may_exceed_its_limit_by_the_stated_tolerance(beyond, status):
    for position in (1.0 + beyond, -1.0 - beyond):
        run = make_run(joint_positions=positions(position))
        assert verdict(run, WithinLimits()).status == status


@pytest.mark.parametrize("beyond", [1e-7, 5e-4, 0.1])
def test_a_commanded_position_has_no_tolerance(beyond):
    at_limit = changed(make_run(), joint_commands=positions(1.0))
    assert verdict(at_limit, WithinLimits()).status == "passed"
    for position in (1.0 + beyond, -1.0 - beyond):
        run = changed(make_run(), joint_commands=positions(position))
        answer = verdict(run, WithinLimits())
        assert answer.status == "failed"
        assert answer.reason.startswith("commanded position of shoulder is ")
        value, limit = re.findall(r"-?[0-9.]+ deg", answer.reason)
        assert value != limit


@pytest.mark.parametrize(
    ("acceleration", "most"), [(5.0, 2.005), (0.1, 2.002), (500.0, 2.02), (np.inf, 2.002)]
)
def test_a_measured_velocity_may_exceed_its_limit_by_a_millisecond_of_acceleration(
    acceleration, most
):
    """By 0.1 % at least and by 1 % at most."""
    for beyond, status in ((-1e-4, "passed"), (1e-4, "failed")):
        run = make_run(joint_velocities=positions(most + beyond))
        joints = tuple(
            replace(each, acceleration=acceleration) if each.name == "shoulder" else each
            for each in ROBOT.joints
        )
        limited = replace(run, robot=replace(run.robot, joints=joints))
        assert verdict(limited, WithinLimits()).status == status


EVIDENCE = Evidence(
    three_runs=(
        Three(
            WithinLimits(), make_run(), shared.with_joint(joint_velocities=2.015), -0.01, "rad/s"
        ),
    ),
    mutation_cases=(
        (
            WithinLimits(acceleration=True),
            shared.late(
                **{
                    **shared.MOVING,
                    "joint_positions": shared.columns((2.0, 0.0), (0.5, 0.02)),
                    "joint_velocities": shared.columns((3.0, 0.0), (2.0, 0.0)),
                }
            ),
            "late",
        ),
        (
            WithinLimits(velocity=False, effort=False),
            replace(
                shared.late(
                    joint_positions=shared.columns((2.0, 0.0), -0.0005),
                    joint_commands=shared.columns(0.0),
                ),
                robot=replace(ROBOT, gripper=None),
            ),
            "late",
        ),
    ),
    picture=(
        ("late", "always: {within_limits: {position: false, effort: false}}"),
        ("hammer", "always: {within_limits: {position: false, effort: false}}"),
    ),
    free_shifts=(
        Free(
            "acceleration is required of the arm",
            "within_limits",
            "joint_command_velocities",
            "+-finger",
        ),
    ),
)
