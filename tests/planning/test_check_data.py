"""Checks of collisions do not depend on the states that were checked before."""

import numpy as np
import pinocchio as pin
import pytest

from harness.language.scenario import RobotSpec
from harness.planning.collision.scene import CoalScene
from harness.robot.load import load_robot
from harness.robot.random_positions import sample_robot_positions


@pytest.mark.nightly
def test_a_check_answers_as_one_that_begins_anew():
    """With Coal's guess from the state before, one of 299 touching pairs was overlooked."""
    description = load_robot(RobotSpec.model_validate({"model": "ur5e", "gripper": "rh_p12_rn_a"}))
    scene = CoalScene(description)
    model = scene.collision_model()
    checked, robot = model.check_data(model.margins(padding=0.0)), model.robot.model
    touching = 0
    for row in sample_robot_positions(description, 300, np.random.default_rng(5)):
        configuration = scene.robot.configuration(row)
        anew = model.geometry.createData()
        for data in (checked, anew):
            pin.computeCollisions(
                robot, robot.createData(), model.geometry, data, configuration, False
            )
        answers = [[r.isCollision() for r in data.collisionResults] for data in (checked, anew)]
        assert answers[0] == answers[1]
        touching += sum(answers[1])
    assert touching > 100
