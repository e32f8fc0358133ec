"""What is executed, how an expectation is worded, what must be recorded."""

import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from harness.judging.expectations.always import Always
from harness.judging.expectations.collision import Collision
from harness.judging.expectations.duration import DurationCheck
from harness.judging.expectations.grasped import Grasped
from harness.judging.expectations.lifted import Lifted
from harness.judging.expectations.never import Never
from harness.judging.expectations.placed import Placed
from harness.judging.expectations.tcp_pose import TcpPose
from harness.judging.expectations.within_limits import WithinLimits
from harness.judging.judge import judge
from harness.judging.observations import (
    CLEARANCE_CUTOFF,
    Observations,
    UndeclaredObservation,
    merged,
    restricted,
)
from harness.judging.placed import PlacedExpectation, describe
from harness.language.poses import Pose
from harness.plugins.arms.expectations.clearance import Clearance
from harness.plugins.cameras.expectations.sees import HueRange, Sees
from harness.plugins.formulas.expectations.formula import Formula
from harness.plugins.formulas.expectations.until import Until
from harness.plugins.objects.expectations.in_ import In
from harness.plugins.objects.expectations.static import Static
from harness.plugins.paths.expectations.fraction import FractionCheck
from harness.plugins.paths.expectations.tcp_path import TcpPath
from tests.judging.synthetic_run import attachment, heights, lift_run, make_run


@pytest.mark.parametrize(
    ("spec", "text"),
    [
        (
            Never(predicate=Collision(between=("robot", "Table"))),
            "never: collision between robot and Table",
        ),
        (Always(predicate=WithinLimits()), "always: joints are within limits"),
        (
            Lifted(object="box", above="5 cm", **{"for": "1 s"}),
            "box is lifted by at least 50.0 mm, for 1.0 s",
        ),
        (Clearance(at_least=0.01), "clearance between robot and any is at least 10.0 mm"),
        (
            TcpPose(pose=Pose(xyz=(0.1, 0, 0)), name="there"),
            "there (TCP is at (100, 0, 0) mm)",
        ),
        (
            Until(predicate=Static(), until=Static(object="box")),
            "everything is static until box is static",
        ),
        (
            In(object="red_cube", container="red_bin", max_lean=math.pi / 4),
            "red_cube is in red_bin",
        ),
        (
            Sees(camera="top", color=HueRange(named="blue"), min_area=20),
            "camera top sees blue, min area 20",
        ),
        (DurationCheck(at_least=1.0, at_most=2.5), "duration is at least 1.0 s and at most 2.5 s"),
        (Placed(object="box", on="tray", during="put"), "box is placed on tray, during put"),
        (Grasped(object="box", min_force=0.05), "box is grasped"),
    ],
)
def test_an_expectation_reads_like_the_file(spec, text):
    assert describe(spec) == text


def test_every_model_can_be_worded():
    specs = [
        In(object="box", container="bin"),
        Sees(camera="wrist", color="red"),
        Sees(camera="wrist", marker=7),
        FractionCheck(at_least=0.5),
    ]
    assert all("None" not in describe(spec) for spec in specs)


def test_verdicts_keep_order_line_step_points_and_text():
    placed = [
        PlacedExpectation(Static(points=2), "", 12),
        PlacedExpectation(Lifted(object="box"), "lift", 9),
    ]
    first, second = judge(lift_run(), placed)
    assert (first.line, first.step, first.points) == (12, "", 2)
    assert first.expectation == describe(Static(points=2))
    assert (second.line, second.step, second.expectation) == (9, "lift", "box is lifted")


def test_observations_name_frames_and_a_sufficient_cutoff():
    needed = merged(
        spec.observations()
        for spec in [
            TcpPose(link="wrist_3_link", pose=Pose(frame="base_link")),
            Always(predicate=Clearance(at_least=0.3)),
            Placed(object="box", pose=Pose(frame="Table")),
            TcpPath(line={"start": {"frame": "tool0"}, "end": {"xyz": [0, 0, 1]}}),
            Formula(formula="always z(elbow_link) > z(tcp)"),
        ]
    )
    links = {"base_link", "elbow_link", "tool0", "wrist_3_link"}
    assert needed.frames == {"Table", "world"} | links
    assert needed.recorded_cutoff == pytest.approx(0.35)
    assert Clearance(at_least=0.01).observations().recorded_cutoff == 0.15
    far = Formula(formula="always distance(robot, box) < 40 cm")
    assert far.observations().recorded_cutoff == pytest.approx(0.45)
    nearer = Formula(formula="always distance(robot, box) < distance(robot, cup)")
    assert nearer.observations().clearance_cutoff == pytest.approx(0.05)
    assert Formula(formula="always z(box) < 1").observations().clearance_cutoff is None


def test_a_cutoff_is_at_least_that_of_every_run():
    assert Observations().recorded_cutoff == CLEARANCE_CUTOFF == 0.15
    assert Observations(clearance_cutoff=0.0).recorded_cutoff == 0.15
    assert Observations(clearance_cutoff=0.2).recorded_cutoff == 0.2


def test_a_link_is_read_where_it_is_declared_fixed_or_carries_something():
    frames = {name: heights(np.full(20, 0.4)) for name in ("arm_link", "palm", "base_link")}
    held = make_run(20, frames=frames, attachments=[attachment("box", 0, 20)])
    for run, link, is_readable in (
        (make_run(20, frames=frames), "arm_link", True),
        (make_run(20, frames=frames), "palm", False),
        (held, "palm", True),
        (replace(held, unrecorded=("attachments",)), "palm", False),
        (make_run(20, frames=frames), "base_link", True),
    ):
        seen = restricted(run, Observations(frozenset({"arm_link"})), "Mine").signals.frames
        if is_readable:
            assert link in seen
            assert seen[link] is frames[link]
            continue
        with pytest.raises(UndeclaredObservation, match="reads the pose of the link 'palm'"):
            assert link in seen
        with pytest.raises(UndeclaredObservation):
            assert seen[link] is None


def test_judging_needs_neither_planner_nor_physics():
    code = (
        "import sys, harness.judging.judge, harness.recording.read_run;"
        "import harness.recording.digest;"
        "heavy = {'mujoco', 'pinocchio', 'coal', 'ompl', 'scipy', 'cv2'};"
        "sys.exit(', '.join(heavy & set(sys.modules)) or 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
