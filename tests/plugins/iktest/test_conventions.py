"""Units, zeros and directions of joints are one mistake, by which the rest is judged."""

from math import cos, degrees, pi, sin

import numpy as np
import pytest

from harness.core.spatial import SE3
from harness.plugins.iktest import IkTest, check_ik, run_ik_test
from harness.robot.robot_source import RobotSource
from tests.plugins.iktest.arms import OM, correct, ur3e
from tests.plugins.iktest.test_joint_limits import spherical
from tests.robot.arm_files import write_arm


def answers(change):
    """The right solver, its answers changed."""

    def ik(x, y, z, pitch):
        return [change(*answer) for answer in correct(x, y, z, pitch)]

    return ik


def targets(length=1.0, angle=1.0):
    """The right solver of targets in other units."""

    def ik(x, y, z, pitch):
        return correct(x * length, y * length, z * length, pitch * angle)

    return ik


def in_degrees(*answer):
    return [degrees(each) for each in answer]


def both(first, second):
    """Targets of one solver, the answers changed as by another."""

    def ik(x, y, z, pitch):
        return [second(*answer) for answer in first(x, y, z, pitch)]

    return ik


def lower_base(x, y, z, pitch):
    return correct(x, y, z - 0.017, pitch)


def centimetres_and_degrees(x, y, z, pitch):
    return [in_degrees(*each) for each in targets(0.01, pi / 180)(x, y, z, pitch)]


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(
    ("ik", "words"),
    [
        (answers(in_degrees), "it is taken in degrees"),
        (targets(0.001), "the target is given in millimetres"),
        (targets(angle=-1), "`pitch` counts upwards"),
        (
            centimetres_and_degrees,
            "it is taken in degrees and the target is given in centimetres and `pitch` is given in"
            " degrees",
        ),
        (answers(lambda a, b, c, d: [a, b + 0.17, c, d]), "joint2 is 0.17 rad less"),
        (answers(lambda a, b, c, d: [a, b, -c, d]), "joint3 counts in the other direction"),
        (
            answers(lambda a, b, c, d: [a, b, 1.2 - c, d]),
            "joint3 is 1.2 rad minus the answer's",
        ),
        (
            answers(lambda a, b, c, d: [a, b - pi / 2, c, d + pi / 2]),
            "joint2 is 1.571 rad more and joint4 is 1.571 rad less",
        ),
        (
            answers(lambda a, b, c, d: in_degrees(a, b, c, d + 0.3)),
            "it is taken in degrees and joint4 is 0.3 rad less",
        ),
    ],
)
def test_a_convention_is_one_finding(ik, words):
    report = run_ik_test(IkTest(ik, OM, examples=40))
    [finding] = report.findings
    assert finding.property == "reaches"
    assert finding.kind == f"counts otherwise: every answer is right when {words}"
    assert finding.shown == finding.tried
    assert not report.has_passed


REVERSED = "joint3 counts in the other direction"
IN_MILLIMETRES = "the target is given in millimetres"


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("ik", "words"),
    [
        (
            both(targets(0.001), lambda a, b, c, d: [a, b, -c, d]),
            f"{REVERSED} and {IN_MILLIMETRES}",
        ),
        pytest.param(
            both(targets(0.001), lambda a, b, c, d: [a, b + 0.17, c, d]),
            f"joint2 is 0.17 rad less and {IN_MILLIMETRES}",
            marks=pytest.mark.nightly,
        ),
        pytest.param(
            both(targets(angle=-1), lambda a, b, c, d: [a, b, -c, d]),
            f"{REVERSED} and `pitch` counts upwards",
            marks=pytest.mark.nightly,
        ),
        pytest.param(
            answers(lambda a, b, c, d: [-a, b, -c, d]),
            f"joint1 counts in the other direction and {REVERSED}",
            marks=pytest.mark.nightly,
        ),
    ],
)
def test_two_conventions_at_once_are_one_finding(ik, words):
    [finding] = run_ik_test(IkTest(ik, OM, examples=20)).findings
    assert finding.kind == f"counts otherwise: every answer is right when {words}"


LOWER = "off by (0.0, 0.0, -17.0) mm in the world's axes"


def on_base(base, change):
    """A UR3e's solver that takes its base for standing elsewhere, its answers changed."""

    def ik(matrix):
        return [change(*answer) for answer in ur3e(np.linalg.inv(base) @ matrix)]

    return ik


def standing(z, tilt=0.0):
    """A base at a height [m], tilted about x [rad]."""
    base = np.eye(4)
    base[1:3, 1:] = [[cos(tilt), -sin(tilt), 0.0], [sin(tilt), cos(tilt), z]]
    return base


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda a, b, c, d: [a, b, -c, d], REVERSED),
        (lambda a, b, c, d: [a, b + 0.17, c, d], "joint2 is 0.17 rad less"),
        (in_degrees, "it is taken in degrees"),
    ],
)
def test_a_convention_and_a_shifted_base_are_one_finding(change, words):
    [finding] = run_ik_test(IkTest(both(lower_base, change), OM, examples=40)).findings
    assert finding.kind == (
        f"counts otherwise: every answer is right when {words}, but {LOWER}, at every target"
    )
    assert finding.shown == finding.tried
    first = lower_base(*finding.target.pose.translation, 0.0)[0]
    assert finding.answer == pytest.approx(change(*first))


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("base", "change", "words"),
    [
        (
            standing(0.017),
            lambda a, b, c, *rest: [a, b, -c, *rest],
            f"elbow_joint counts in the other direction, but {LOWER}",
        ),
        (
            standing(0.017),
            lambda a, b, *rest: [a, b + 0.17, *rest],
            f"shoulder_lift_joint is 0.17 rad less, but {LOWER}",
        ),
        (
            standing(0.0, 0.1),
            in_degrees,
            "it is taken in degrees, but turned by 5.7 deg about (-1.00, 0.00, 0.00) in the"
            " world's axes",
        ),
    ],
)
def test_so_they_are_of_an_arm_that_takes_poses(base, change, words):
    findings = run_ik_test(IkTest(on_base(base, change), "ur3e", examples=20)).findings
    [kind] = [each.kind for each in findings if each.property == "reaches"]
    assert kind == f"counts otherwise: every answer is right when {words}, at every target"
    assert not any("off by" in each.kind or "misses" in each.kind for each in findings[1:])


def w_first(position, quat_wxyz):
    """A right solver."""
    return ur3e(SE3.from_xyz_quat(position, quat_wxyz).matrix())


def w_last(position, quat_xyzw):
    """A right solver, too."""
    return w_first(position, np.roll(quat_xyzw, 1))


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("ik", "words"),
    [
        (lambda position, quat_wxyz: w_last(position, quat_wxyz), "last"),
        (lambda position, quat_xyzw: w_first(position, quat_xyzw), "first"),
        (
            lambda position, quat_wxyz: w_last(position - [0, 0, 0.017], quat_wxyz),
            f"last, but {LOWER}, at every target",
        ),
    ],
)
def test_the_other_order_of_a_quaternion_is_recognised(ik, words):
    kinds = [each.kind for each in run_ik_test(IkTest(ik, "ur3e", examples=20)).findings]
    assert kinds[0] == (
        f"counts otherwise: every answer is right when the quaternion's w comes {words}"
    )
    assert not any("off by" in kind or "misses" in kind for kind in kinds[1:])


@pytest.mark.nightly
@pytest.mark.parametrize("ik", [w_first, w_last])
def test_either_order_is_right(ik):
    check_ik(ik, "ur3e", examples=10)


IN_DEGREES = "counts otherwise: every answer is right when it is taken in degrees"


def refuses(x, y, z, pitch):
    return None if y > 0.1 else lower_base(x, y, z, pitch)


def low_on_the_right(x, y, z, pitch):
    return correct(x, y, z - 0.017 * (y < 0), pitch)


def wide_of_far_targets(x, y, z, pitch):
    return lower_base(x, y + 0.05 * y * (y > 0.15), z, pitch)


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("ik", "kinds"),
    [
        (
            both(lambda *target: refuses(*target) or [], in_degrees),
            [f"{IN_DEGREES}, but {LOWER}, at every target", "refuses a target within reach"],
        ),
        (
            both(low_on_the_right, in_degrees),
            [f"{IN_DEGREES}, but {LOWER}, at many targets", f"is {LOWER}, at many targets"],
        ),
    ],
)
def test_what_is_wrong_besides_is_found_too(ik, kinds):
    findings = run_ik_test(IkTest(ik, OM, examples=40)).findings
    assert [each.kind for each in findings[:2]] == kinds


@pytest.mark.nightly
def test_what_is_wrong_besides_both_is_a_finding_of_its_own():
    ik = both(wide_of_far_targets, in_degrees)
    kinds = [each.kind for each in run_ik_test(IkTest(ik, OM, examples=40)).findings]
    assert kinds[0].startswith("counts otherwise: ")
    assert kinds[0].endswith(f" right when it is taken in degrees, but {LOWER}, at every target")
    assert kinds[0] != f"{IN_DEGREES}, but {LOWER}, at every target"
    assert "misses the position" in kinds
    assert not any(each.startswith("is off") for each in kinds)


@pytest.mark.nightly
def test_lengths_of_a_slide_and_the_zero_of_a_joint_without_limits_are_recognised(tmp_path):
    write_arm(tmp_path)
    source = RobotSource(str(tmp_path / "arm.urdf"), srdf=str(tmp_path / "arm.srdf"))
    right = spherical(0.0)

    def millimetres(x, y, z):
        return [[a, b, 1000 * c] for a, b, c in right(x, y, z) or []]

    def turned(x, y, z):
        return [[a + 0.4, b, c] for a, b, c in right(x, y, z) or []]

    [finding] = run_ik_test(IkTest(millimetres, source, examples=40)).findings
    assert finding.kind.endswith("right when its lengths are taken in millimetres")
    [finding] = run_ik_test(IkTest(turned, source, examples=40)).findings
    assert finding.kind.endswith("right when turn is 0.4 rad less")


@pytest.mark.nightly
@pytest.mark.parametrize(
    "ik",
    [
        lambda x, y, z, pitch: [0.1, 0.2, 0.3, 0.4],  # noqa: ARG005
        lambda x, y, z, pitch: correct(1.1 * x, 1.1 * y, z, pitch),
        answers(lambda a, b, c, d: [a, b + 0.1 * np.sin(a), c, d]),
        answers(lambda a, b, c, d: [a, b, c * 0.9, d]),
        both(lambda x, y, z, pitch: correct(x, y, 1.1 * z - 0.017, pitch), in_degrees),
    ],
)
def test_what_is_wrong_by_no_convention_is_not_said_to_be_right_by_one(ik):
    kinds = [each.kind for each in run_ik_test(IkTest(ik, OM, examples=40)).findings]
    assert kinds
    assert not any("counts otherwise" in kind for kind in kinds)
