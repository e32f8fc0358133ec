"""RRT-Connect and shortcuts of the wheel `roboplan` (C++), on the same meshes and things."""

import time
from dataclasses import replace
from itertools import combinations, pairwise

import numpy as np
import roboplan.core as core
import roboplan.rrt as rrt

from harness.core.geometry import Box, Cylinder
from harness.planning.verification.verify import FINAL_RESOLUTION
from harness.robot.urdf.write import write_urdf
from tests.benchmarks.planning.arms import packages
from tests.benchmarks.planning.contenders import PATIENCE, RANGE, SPACING, Outcome
from tests.benchmarks.planning.problems import Problem

COLOUR = np.full(4, 0.5)
GROUND = core.Box(10.0, 10.0, 1.0)
MOST_NODES = 100_000
FINE = 1 / 1024
"""Joint-space distance between the states that are verified [rad]."""


def roboplan(problem: Problem, seed: int = 1) -> Outcome:
    """As it comes: plan and cut corners at `SPACING`, nothing verified."""
    return _planned(problem, seed, ((SPACING, SPACING),), None)


def roboplan_verified(problem: Problem, seed: int = 1) -> Outcome:
    """Verified at `FINE`, and planned anew at a finer spacing when that fails."""
    return _planned(problem, seed, LEVELS, FINE)


LEVELS = (
    (SPACING, FINAL_RESOLUTION),
    (FINAL_RESOLUTION, FINAL_RESOLUTION),
    (FINAL_RESOLUTION, FINE),
    (FINE, FINE),
)
"""Spacings of states while planning and while cutting corners [rad]."""


def _planned(
    problem: Problem, seed: int, levels: tuple[tuple[float, float], ...], verify: float | None
) -> Outcome:
    scene = _robot(problem)
    before = time.process_time()
    _load_scene(scene, problem)
    begin, planned = time.process_time(), None
    for spacing, fine in levels:
        path = _plan(scene, problem, spacing, seed)
        if path is None:
            continue
        planned = planned or time.process_time()
        options = core.PathShortcuttingOptions(
            group_name=problem.arm.group, max_step_size=fine, seed=seed
        )
        short = np.array(core.PathShortcutter(scene, options).shortcut(path).positions)
        if verify is None or not any(
            core.hasCollisionsAlongPath(scene, first, second, verify)
            for first, second in pairwise(short)
        ):
            done = time.process_time()
            return Outcome(begin - before, planned - begin, done - begin, short)
    return Outcome(begin - before, PATIENCE, PATIENCE, None)


def _plan(scene: core.Scene, problem: Problem, spacing: float, seed: int) -> core.JointPath | None:
    options = rrt.RRTOptions(
        group_name=problem.arm.group,
        max_nodes=MOST_NODES,
        max_connection_distance=RANGE,
        collision_check_step_size=spacing,
        max_planning_time=PATIENCE,
        rrt_connect=True,
    )
    planner = rrt.RRT(scene, options)
    planner.setRngSeed(seed)
    names = list(problem.space.joint_names)
    try:
        return planner.plan(
            core.JointConfiguration(names, problem.start),
            core.JointConfiguration(names, problem.goal),
        )
    except RuntimeError:  # nothing found
        return None


def _robot(problem: Problem) -> core.Scene:
    """A scene with the arm alone."""
    description = problem.arm.description("exact")
    arm_joints = description.groups[problem.arm.group].joint_names
    joints = [  # the gripper stays open, as it does for the others
        joint if joint.name in arm_joints else replace(joint, kind="fixed", mimic=None)
        for joint in description.joints
    ]
    urdf = write_urdf("arm", description.links, joints)
    folders = [str(place.parent) for place in packages().values()]
    scene = core.Scene("arm", core.loadUrdfSceneDescriptionFromXml(urdf, folders))
    scene.addGroup(problem.arm.group, list(problem.space.joint_names))
    return scene


def _load_scene(scene: core.Scene, problem: Problem) -> None:
    """Add things and ground; the same pairs are checked as by the others."""
    description = problem.arm.description("exact")
    solid = {link.name for link in description.links if link.collisions}
    allowed = [pair for pair in description.allowed_collisions if solid.issuperset(pair)]
    for number, shape in enumerate(problem.obstacles):
        _add(scene, f"thing{number}", shape.geometry, shape.pose.matrix())
    things = [f"thing{number}" for number in range(len(problem.obstacles))]
    if problem.ground is not None:
        ground = np.eye(4)
        ground[2, 3] = problem.ground - 0.5
        scene.addBoxGeometry("ground", "universe", GROUND, np.asfortranarray(ground), COLOUR)
        things.append("ground")
    scene.setCollisions([*allowed, *combinations(things, 2)], False)


def _add(scene: core.Scene, name: str, geometry: Box | Cylinder, pose: np.ndarray) -> None:
    place = np.asfortranarray(pose)
    if isinstance(geometry, Box):
        scene.addBoxGeometry(name, "universe", core.Box(*geometry.size), place, COLOUR)
    else:
        cylinder = core.Cylinder(geometry.radius, geometry.length)
        scene.addCylinderGeometry(name, "universe", cylinder, place, COLOUR)
