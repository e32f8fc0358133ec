"""Problems of the data set MotionBenchMaker, which this repository does not contain.

Its scenes and requests are MoveIt messages in YAML, one folder for each arm and family, next to the
arm's URDF and SRDF: `ur5/ur5.urdf`, `ur5/problems/cage_ur5/scene0001.yaml`. The source archive of
vamp-planner on PyPI has them in `resources`, with each arm's problems in an archive. Those of the
Fetch and the Baxter are in that project's repository alone; the Baxter's are for both of its arms.
"""

import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from harness.core.geometry import Shape
from harness.core.spatial import SE3
from harness.planning.backend import make_planning
from harness.planning.model.robot_model import GroupSpace
from harness.plugins.formats.moveit_messages.request import read_request
from harness.plugins.formats.moveit_messages.scene import read_scene
from harness.robot.packages import PackagePath
from harness.world.objects import resolve_object
from tests.benchmarks.planning.arms import Arm
from tests.benchmarks.planning.problems import (
    Problem,
    Route,
    add_object,
    free_by_broad_phase,
)

FOLDER = os.environ.get("MOTION_BENCH_MAKER", "")
FAMILIES = (
    *("bookshelf_small", "bookshelf_tall", "bookshelf_thin", "box", "cage"),
    *("table_pick", "table_under_pick"),
)


def _arm(name: str, group: str) -> Arm:
    def files() -> dict[str, str]:
        return {kind: str(Path(FOLDER, name, f"{name}.{kind}")) for kind in ("urdf", "srdf")}

    title = f"{name}, {group}, of MotionBenchMaker"
    return Arm(title, files, group, flange="", ready=(), usual={}, scale=1)


BOTH_ARMS = tuple(f"bookshelf_tall_both_arms_{level}" for level in ("easy", "medium", "hard"))
ARMS = (
    ("ur5", _arm("ur5", "manipulator"), FAMILIES),
    ("panda", _arm("panda", "panda_arm"), FAMILIES),
    ("fetch", _arm("fetch", "arm_with_torso"), FAMILIES),
    ("baxter", _arm("baxter", "left_arm"), BOTH_ARMS),
    ("baxter", _arm("baxter", "both_arms"), BOTH_ARMS),
)


def motion_bench_maker(route: Route, each: int, seed: int) -> Iterator[Problem]:
    """`each` problems of every arm and family, drawn; those with free ends on the route's shapes.

    Convex parts with padding touch more than meshes do: a few problems in a hundred are left out,
    and those of robots whose folder is missing.
    """
    rng = np.random.default_rng(seed)
    for robot, arm, families in ARMS:
        for family in families:
            folder = Path(FOLDER, robot, "problems", f"{family}_{robot}")
            count = len([*folder.glob("request*.yaml")])
            for number, index in enumerate(1 + rng.permutation(count)[:each]):
                problem = _problem(route, arm, family, number, folder, int(index))
                is_free = free_by_broad_phase(problem)
                if is_free(problem.start) and is_free(problem.goal):
                    yield problem


def _problem(route: Route, arm: Arm, family: str, number: int, folder: Path, index: int) -> Problem:
    description = arm.description(route.collision)
    request = read_request(folder / f"request{index:04d}.yaml")
    scene, kinematics, _ = make_planning(description)
    obstacles = tuple(_shapes(folder / f"scene{index:04d}.yaml"))
    for place, shape in enumerate(obstacles):
        add_object(scene, f"thing{place}", shape)
    start = {name: value for name, (value, _) in request.start.items()}
    whole = np.array([start.get(name, 0.0) for name in description.joint_names])
    space = GroupSpace(kinematics.robot, arm.group, whole)
    goal = request.goals[0]["joints"]
    ends = [np.array([float(end[name]) for name in space.joint_names]) for end in (start, goal)]
    return Problem(arm, family, number, route, obstacles, scene, space, *ends, ground=None)


def _shapes(file: Path) -> Iterator[Shape]:
    """The primitives of a scene in the world."""
    found = read_scene(file, ("base_link", "panda_link0"), PackagePath.of_file(file))
    for spec in found.world.objects:
        yield from resolve_object(spec, SE3.identity(), file.parent).shapes
