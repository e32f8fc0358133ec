"""effort: joint efforts stay below a share of their limits."""

from dataclasses import replace

import numpy as np
import pytest

from harness.plugins.arms.expectations.effort import Effort
from harness.robot.mechanism import Mimic
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Three
from tests.judging.synthetic_run import ROBOT, make_run, verdict


def positions(shoulder, finger=0.0):
    return np.tile([shoulder, finger], (200, 1))


def test_effort_is_a_share_of_the_limit():
    run = make_run(joint_efforts=positions(-5.0))
    assert verdict(run, Effort(max_fraction=0.6)).margin == pytest.approx(0.1)
    assert verdict(run, Effort(max_fraction=0.4)).status == "failed"
    assert verdict(run, Effort(during="gone")).status == "not reached"


def test_a_joint_without_a_limit_or_a_record_of_its_own_is_left_out():
    shoulder, finger = ROBOT.movable_joints
    free = replace(shoulder, name="free", effort=np.inf)
    mimic = replace(finger, name="mimic", mimic=Mimic("finger"))
    robot = replace(ROBOT, joints=(shoulder, finger, free, mimic))
    efforts = np.tile([5.0, 4.0, 1e6, np.nan], (200, 1))
    more = {"joint_positions": np.zeros((200, 4)), "joint_velocities": np.zeros((200, 4))}
    answer = verdict(make_run(robot=robot, joint_efforts=efforts, **more), Effort())
    assert answer.status == "passed"
    assert [measure.detail for measure in answer.measures] == ["shoulder", "finger"]
    many = tuple(replace(shoulder, name=name) for name in "abcd")
    run = make_run(robot=replace(ROBOT, joints=(*many, finger)), joint_efforts=np.ones((200, 5)))
    assert len(verdict(run, Effort()).measures) == 3, "the three that use most of their limits"


EVIDENCE = Evidence(
    three_runs=(
        Three(
            Effort(max_fraction=0.5), make_run(), shared.with_joint(joint_efforts=5.05), -0.005, "1"
        ),
    ),
    mutation_cases=((Effort(max_fraction=0.5), shared.late(**shared.MOVING), "late"),),
    picture=(("pick", "0.9"), ("wall", "0.9")),
)
