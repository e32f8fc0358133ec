"""Plans that cases share: the same bytes, and only where everything that decides them is equal."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core import sharing
from harness.core.errors import PlanningFailed
from harness.core.geometry import Box, Friction, Shape
from harness.ports.goals import JointGoal
from harness.ports.motion_planning import MotionRequest, PlanningOptions
from harness.ports.motions import FreeMotion
from tests.planning.lesson import ARM, Cell, at, grasp_goal, thing, ur

POST = thing("post", at(0.3, 0.35, 1.2), Shape(Box((0.05, 0.05, 0.3))))
OPTIONS = PlanningOptions(seed=3)


@pytest.fixture(autouse=True)
def folder():
    sharing.open_folder()
    yield
    sharing.close_folder()


def planned(post=POST, options=OPTIONS, nudge=0.0):
    """A plan in a scene of its own; with it, whether it was taken from an earlier one."""
    cell = Cell(ur("ur3e"))
    cell.add(post)
    start = cell.state.copy()
    start[0] += nudge
    goal = JointGoal(np.array([1.2, -0.7, 0.9, -1.9, -1.57, 0.4]))
    tally = sharing.begin()
    plan = cell.planner.plan(MotionRequest(ARM, start, FreeMotion(goal), options))
    return plan, bool(tally.taken["plans"])


def test_an_equal_problem_takes_the_plan_and_another_one_does_not():
    computed, taken = planned()
    assert not taken
    again, taken = planned()
    assert taken
    assert again.trajectory.positions.tobytes() == computed.trajectory.positions.tobytes()
    assert again.statistics == computed.statistics
    moved = replace(POST, pose=at(np.nextafter(0.3, 1), 0.35, 1.2))
    wider = replace(POST, shapes=(Shape(Box((0.06, 0.05, 0.3))),))
    for other in (
        {"post": moved},
        {"post": wider},
        {"options": replace(OPTIONS, seed=4)},
        {"options": replace(OPTIONS, padding=0.003)},
        {"nudge": 1e-12},
    ):
        assert not planned(**other)[1], other


def test_surfaces_and_the_mass_of_what_is_not_held_do_not_matter():
    planned()
    slippery = replace(POST, friction=Friction(0.1), mass=2.0)
    painted = replace(POST, shapes=tuple(replace(each, rgba=(0, 0, 0, 1)) for each in POST.shapes))
    assert planned(slippery)[1]
    assert planned(painted)[1]


def test_the_mass_of_what_is_held_matters():
    def lifted(mass):
        cell = Cell(ur("ur3e"))
        cube = thing("cube", at(0.32, -0.168, 1.3), Shape(Box((0.03,) * 3)), static=False)
        cell.add(replace(cube, mass=mass, inertia=mass * 1e-4 * np.eye(3)))
        cell.scene.attach_object("cube", "end_effector_link", (), cell.state)
        goal = JointGoal(cell.named("up"))
        tally = sharing.begin()
        cell.planner.plan(MotionRequest(ARM, cell.state, FreeMotion(goal), OPTIONS))
        return bool(tally.taken["plans"])

    assert [lifted(0.1), lifted(0.1), lifted(0.2)] == [False, True, False]


def test_a_failure_is_shared_with_its_explanation():
    def failure():
        cell = Cell(ur("ur3e"))
        request = MotionRequest(ARM, cell.state, FreeMotion(grasp_goal(1.5, 0, 0.3)), OPTIONS)
        with pytest.raises(PlanningFailed) as failed:
            cell.planner.plan(request)
        return failed.value

    tally = sharing.begin()
    first, second = failure(), failure()
    assert tally.taken["plans"] == 1
    assert (first.code, str(first), first.facts) == (second.code, str(second), second.facts)
