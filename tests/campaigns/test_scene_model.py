"""The planning scene equals a simple model, after any objects and attachments come and go."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    invariant,
    precondition,
    rule,
    run_state_machine_as_test,
)

from harness.core.geometry import Box, Shape, Sphere
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.language.scenario import RobotSpec
from harness.planning.collision.scene import CoalScene
from harness.robot.load import load_robot

NAMES = ("a", "b", "c")
LINKS = ("link3", "link5", "gripper_left_link")
places = st.sampled_from([(0.15, 0.0, 0.1), (0.2, 0.05, 0.15), (0.0, 0.0, 0.3), (0.4, 0.0, 0.0)])
names = st.sampled_from(NAMES)
angles = st.sampled_from([-0.8, -0.2, 0.0, 0.4, 1.0])


@cache
def robot():
    return load_robot(RobotSpec(model="open_manipulator_x"))


def thing(name):
    geometry = Sphere(0.03) if name == "a" else Box((0.03, 0.04, 0.05))
    still, inertia = np.zeros(3), 1e-4 * np.eye(3)
    return WorldObject(name, (Shape(geometry),), SE3.identity(), False, 0.1, still, inertia)


class SceneModel(RuleBasedStateMachine):
    """A scene next to a model: poses in the world, or in the links that carry the objects."""

    def __init__(self):
        super().__init__()
        self.scene = CoalScene(robot())
        self.positions = np.array(robot().start_positions(), dtype=float)
        self.poses: dict[str, SE3] = {}
        self.carried: dict[str, tuple[str, SE3]] = {}
        self.allowed: set[tuple[str, str]] = set()

    def link_pose(self, link):
        return robot().link_poses(self.positions)[link]

    def pose_of(self, name):
        if name not in self.carried:
            return self.poses[name]
        link, inside = self.carried[name]
        return self.link_pose(link) @ inside

    @rule(joint=st.integers(0, 3), angle=angles)
    def move_arm(self, joint, angle):
        self.positions = self.positions.copy()
        self.positions[joint] = angle

    @rule(name=names, xyz=places, angle=angles)
    def add(self, name, xyz, angle):
        if name not in self.poses:
            pose = SE3.from_xyz_rpy(xyz, (0.0, 0.0, angle))
            self.scene.add_object(thing(name), pose)
            self.poses[name] = pose

    @precondition(lambda self: self.poses.keys() - self.carried.keys())
    @rule(data=st.data(), xyz=places)
    def move(self, data, xyz):
        name = data.draw(st.sampled_from(sorted(self.poses.keys() - self.carried.keys())))
        self.poses[name] = SE3.from_xyz_rpy(xyz, (0.1, 0.0, 0.2))
        self.scene.move_object(name, self.poses[name])

    @precondition(lambda self: self.poses.keys() - self.carried.keys())
    @rule(data=st.data(), link=st.sampled_from(LINKS))
    def attach(self, data, link):
        name = data.draw(st.sampled_from(sorted(self.poses.keys() - self.carried.keys())))
        inside = self.scene.attach_object(name, link, (link,), self.positions)
        expected = self.link_pose(link).inverse() @ self.poses[name]
        assert inside.as_vector() == pytest.approx(expected.as_vector(), abs=1e-9)
        self.carried[name] = link, expected

    @precondition(lambda self: self.carried)
    @rule(data=st.data())
    def detach(self, data):
        name = data.draw(st.sampled_from(sorted(self.carried)))
        expected = self.pose_of(name)
        found = self.scene.detach_object(name, self.positions)
        assert found.as_vector() == pytest.approx(expected.as_vector(), abs=1e-9)
        self.poses[name] = expected
        del self.carried[name]

    @precondition(lambda self: self.poses.keys() - self.carried.keys())
    @rule(data=st.data())
    def remove(self, data):
        name = data.draw(st.sampled_from(sorted(self.poses.keys() - self.carried.keys())))
        self.scene.remove_object(name)
        del self.poses[name]
        self.allowed = {pair for pair in self.allowed if name not in pair}

    @rule(name=names, link=st.sampled_from(LINKS), allowed=st.booleans())
    def allow(self, name, link, allowed):
        if name in self.poses:
            self.scene.set_allowed([(link, name)], allowed=allowed)
            (self.allowed.add if allowed else self.allowed.discard)((link, name))

    @invariant()
    def names_and_attachments_are_those_of_the_model(self):
        assert set(self.scene.object_names()) == self.poses.keys()
        assert dict(self.scene.attached()) == {n: link for n, (link, _) in self.carried.items()}

    @invariant()
    def objects_are_where_the_model_has_them(self):
        for name in self.poses:
            found = self.scene.object_pose(name, self.positions)
            expected = self.pose_of(name).as_vector()
            assert found.as_vector() == pytest.approx(expected, abs=1e-9)

    @invariant()
    def touches_are_those_of_a_scene_that_is_made_anew(self):
        fresh = CoalScene(robot())
        for name in self.poses:
            fresh.add_object(thing(name), self.pose_of(name))
        for name, (link, _) in self.carried.items():
            fresh.attach_object(name, link, (link,), self.positions)
        fresh.set_allowed(sorted(self.allowed), allowed=True)
        found, expected = (
            sorted((*sorted((each.first, each.second)), each.distance) for each in touches)
            for touches in (self.scene.touches(self.positions), fresh.touches(self.positions))
        )
        assert [each[:2] for each in found] == [each[:2] for each in expected]
        distances = [[each[2] for each in touches] for touches in (found, expected)]
        assert distances[0] == pytest.approx(distances[1], abs=1e-6)


@pytest.mark.nightly(but=["8"])
@pytest.mark.parametrize("examples", [8, 300])
def test_the_planning_scene_equals_a_simple_model(examples):
    few = settings(max_examples=examples, stateful_step_count=12, deadline=None)
    run_state_machine_as_test(SceneModel, settings=few)
