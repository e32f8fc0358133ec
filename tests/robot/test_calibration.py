"""UR calibration files: the flange moves by what the file says."""

import mujoco
import numpy as np
import pytest

from harness.core.errors import RobotError, SpecError
from harness.language.scenario import RobotSpec
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.ports.goals import PoseGoal
from harness.robot.load import load_robot
from harness.simulation.servo import bare_robot
from tests.robot.models import robot
from tests.robot.ur_calibration import SECTIONS, calibration_text

POSITIONS = np.array([0.4, -1.1, 1.3, -0.7, 0.9, 0.3])


def write(folder, sections):
    (folder / "arm.yaml").write_text(calibration_text(sections), encoding="utf-8")


def load(folder, **words):
    words = {"model": "ur5e", "kinematics": "arm.yaml", **words}
    return load_robot(RobotSpec.model_validate(words), folder)


def turn(axis, angle):
    """A rotation about x, y or z, as a 4 by 4 matrix, written down without the program's own."""
    cosine, sine = np.cos(angle), np.sin(angle)
    T = np.eye(4)
    first, second = [index for index in range(3) if index != axis]
    sign = -1 if axis == 1 else 1
    T[first, first] = T[second, second] = cosine
    T[first, second], T[second, first] = -sign * sine, sign * sine
    return T


def flange_by_hand(sections):
    """T_base_flange: base_link_inertia stands turned by half a turn in base_link."""
    T = turn(2, np.pi)
    for values, angle in zip(sections.values(), POSITIONS, strict=True):
        x, y, z, roll, pitch, yaw = values
        step = np.eye(4)
        step[:3, 3] = x, y, z
        T = T @ step @ turn(2, yaw) @ turn(1, pitch) @ turn(0, roll) @ turn(2, angle)
    return T


def test_the_flange_moves_by_the_right_amount(tmp_path):
    write(tmp_path, SECTIONS)
    arm, nominal = load(tmp_path), robot(model="ur5e")
    here = PinocchioKinematics(arm).link_pose(POSITIONS, "tool0")
    expected = flange_by_hand(SECTIONS)
    assert here.translation == pytest.approx(expected[:3, 3], abs=1e-9)
    there = PinocchioKinematics(nominal).link_pose(POSITIONS, "tool0")
    assert 0.001 < np.linalg.norm(here.translation - there.translation) < 0.02


def test_the_calibration_is_named_in_the_notes(tmp_path):
    write(tmp_path, SECTIONS)
    assert "the joints' poses are those of the calibration arm.yaml" in load(tmp_path).notes


def test_planner_and_physics_are_calibrated_alike(tmp_path):
    write(tmp_path, SECTIONS)
    arm = load(tmp_path)
    model = bare_robot(arm).compile()
    data = mujoco.MjData(model)
    data.qpos[:] = POSITIONS
    mujoco.mj_kinematics(model, data)
    assert data.body("tool0").xpos == pytest.approx(flange_by_hand(SECTIONS)[:3, 3], abs=1e-9)


def test_inverse_kinematics_reaches_the_calibrated_pose(tmp_path):
    write(tmp_path, SECTIONS)
    kinematics = PinocchioKinematics(load(tmp_path))
    goal = PoseGoal("tool0", kinematics.link_pose(POSITIONS, "tool0"))
    solutions = kinematics.solve("ur_manipulator", goal, POSITIONS, 1)
    assert len(solutions) >= 4
    for solution in solutions:
        shift, angle = kinematics.link_pose(solution, "tool0").distance_to(goal.pose)
        assert shift < 1e-6
        assert angle < 1e-6


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        ({**SECTIONS, "forearm": ("far", 0, 0, 0, 0, 0)}, ["arm.yaml:17:8", "expected a number"]),
        ({**SECTIONS, "forearm": (-0.2, 0, 0, 0, 0, 0)}, ["225 mm", "another type"]),
        ({"shoulder": SECTIONS["shoulder"]}, ["arm.yaml:2:3", "no `upper_arm`"]),
    ],
)
def test_a_calibration_of_something_else_is_refused(tmp_path, sections, words):
    write(tmp_path, sections)
    with pytest.raises(SpecError) as caught:
        load(tmp_path)
    for word in words:
        assert word in str(caught.value)


def test_a_calibration_is_of_a_ur(tmp_path):
    write(tmp_path, SECTIONS)
    with pytest.raises(SpecError, match="the calibration is of a UR arm"):
        load(tmp_path, model="open_manipulator_x")
    with pytest.raises(RobotError, match="there is no file"):
        load(tmp_path, kinematics="gone.yaml")
