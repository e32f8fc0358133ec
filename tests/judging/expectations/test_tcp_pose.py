"""tcp_pose: the TCP, or another link, stands at a pose."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.judging.expectations.tcp_pose import TcpPose
from harness.language.poses import Pose
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Three
from tests.judging.synthetic_run import BOX, TABLE, at, heights, make_run, verdict

ABSENT = np.full((200, 7), np.nan)


def absent_box(n=200):
    never_there = replace(BOX, present=())
    return make_run(n, objects=(TABLE, never_there), object_poses={"box": ABSENT[:n]})


def test_the_tcp_is_where_it_should_be_within_both_tolerances():
    tilted = at(200, (0, 0, 0.3), SE3.from_xyz_rpy(rpy=(0.009, 0.009, 0)).quat_wxyz)
    run = make_run(tcp_pose=tilted)
    answer = verdict(run, TcpPose(pose=Pose(xyz=(0, 0.0002, 0.3))))
    assert answer.status == "passed", "each axis by itself is within 0.01 rad"
    assert answer.unit == "rad", "the tighter of the two is the margin"
    assert {measure.unit for measure in answer.measures} == {"m", "rad"}
    assert verdict(run, TcpPose(pose=Pose(xyz=(0, 0.0011, 0.3)))).margin == pytest.approx(-1e-4)
    turned = Pose(xyz=(0, 0, 0.3), rpy=(0.02, 0, 0))
    assert verdict(run, TcpPose(pose=turned)).status == "failed"
    assert verdict(run, TcpPose(pose=turned, position_only=True)).status == "passed"


def test_a_position_error_says_where_it_was_to_be_and_where_it_was():
    run = make_run(tcp_pose=heights(np.full(200, 0.3)))
    answer = verdict(run, TcpPose(pose=Pose(xyz=(0, 0.5, 0.3)), position_only=True))
    [measure] = answer.measures
    assert measure.expected == pytest.approx((0, 0.5, 0.3))
    assert measure.actual == pytest.approx((0, 0, 0.3))


def test_a_pose_in_the_frame_of_a_fixed_link_or_of_an_object():
    run = make_run()
    assert verdict(run, TcpPose(pose=Pose(xyz=(0, 0, -0.2), frame="base_link"))).status == "passed"
    assert verdict(run, TcpPose(pose=Pose(xyz=(0, 0, 0.28), frame="box"))).status == "passed"
    assert verdict(run, TcpPose(pose=Pose(xyz=(0, 0, -0.2), frame="world"))).status == "failed"


def test_a_link_that_was_not_recorded_cannot_be_judged():
    spec = TcpPose(link="arm_link", pose=Pose(xyz=(0, 0, 0.3)))
    assert verdict(make_run(), spec).status == "not observable"
    recorded = make_run(frames={"arm_link": at(200, (0, 0, 0.3))})
    assert verdict(recorded, spec).status == "passed"
    in_frame = TcpPose(pose=Pose(frame="box", xyz=(0, 0, 0.28)))
    assert verdict(absent_box(), in_frame).status == "not reached"


EVIDENCE = Evidence(
    three_runs=(
        Three(
            TcpPose(pose=Pose(xyz=(0, 0, 0.3))),
            make_run(),
            make_run(tcp_pose=at(shared.N, (0, 0.00105, 0.3))),
            -5e-5,
            "m",
        ),
    ),
    mutation_cases=(
        (
            TcpPose(pose=Pose(xyz=(0, 0, 0.3), frame="box")),
            shared.late(
                tcp_pose=shared.halves((0, 0.1, 0.3, 0.5), (0, 0, 0.32, 0)),
                object_poses={"box": shared.halves((0.1, 0, 0, 0), (0, 0, 0.02, 0))},
            ),
            "late",
        ),
        (
            TcpPose(link="arm_link", pose=Pose(xyz=(0, 0, 0.3))),
            shared.late(frames={"arm_link": shared.halves((0, 0.1, 0.3, 0.5), (0, 0, 0.3, 0))}),
            "late",
        ),
    ),
    picture=(
        ("pick", "{pose: {xyz: [0.25, 0, 0.06]}, position_only: true, during: reach}"),
        ("pick", "{pose: {xyz: [0.252, 0, 0.06]}, position_only: true, during: reach}"),
    ),
)
