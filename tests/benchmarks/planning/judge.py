"""Judges paths by Coal alone, more finely than anyone who plans verifies them."""

# pyright: reportAttributeAccessIssue=false

from collections.abc import Callable
from functools import cached_property
from itertools import pairwise

import numpy as np
import pinocchio as pin

from harness.core.types import FloatArray
from tests.benchmarks.planning.problems import Problem, free_by_margins

JUDGED = 1 / 131072
"""Joint-space distance between the states at which final paths are judged [rad]."""

WIDEST = 1 / 16
"""Largest joint-space distance over which a state vouches for others [rad]."""


class Judge:
    """Checks states of a problem with margins that are larger by what others can be nearer."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self._checks: dict[int, Callable[[FloatArray], bool]] = {}

    def is_free(self, waypoints: FloatArray) -> bool:
        """Whether all states of a path keep their margins."""
        return all(self._edge_free(*edge) for edge in pairwise(waypoints))

    def _edge_free(self, first: FloatArray, second: FloatArray) -> bool:
        length = float(np.linalg.norm(second - first))
        count = max(1, int(np.ceil(length / JUDGED)))
        waiting = [(0, count)]
        while waiting:
            low, high = waiting.pop()
            middle = (low + high) // 2
            state = first + (second - first) * (middle / count)
            away = (high - middle) * length / count
            if 0 < away <= WIDEST and self._keeps(state, int(np.floor(-np.log2(away)))):
                continue
            if not self._keeps(state):
                return False
            if low < middle:
                waiting.append((low, middle - 1))
            if middle < high:
                waiting.append((middle + 1, high))
        return True

    def _keeps(self, state: FloatArray, level: int = 0) -> bool:
        """Whether a state keeps its margins, and all others at most 2**-level away; 0: it alone."""
        if level not in self._checks:
            extra = self._rates * 2.0**-level if level else 0.0
            self._checks[level] = free_by_margins(self.problem, extra)
        return self._checks[level](state)

    @cached_property
    def _rates(self) -> FloatArray:
        """How much nearer each pair comes at most by a turn of the joints by 1 rad [m]."""
        model, space = self.problem.scene.collision_model(), self.problem.space
        assert space.wraps.all()
        robot = model.robot.model
        data = robot.createData()
        pin.forwardKinematics(robot, data, space.configuration(self.problem.start))
        places = [pose.translation for pose in data.oMi]
        levers = []
        for body in model.bodies:
            found, joint = dict.fromkeys(space.joint_names, 0.0), body.rigid.joint
            low, high = np.abs(body.rigid.box).reshape(2, 3)
            lever = float(np.linalg.norm(np.maximum(low, high)))
            while joint > 0:
                found[robot.names[joint]] = lever
                lever += float(np.linalg.norm(places[joint] - places[robot.parents[joint]]))
                joint = robot.parents[joint]
            levers.append([found[name] for name in space.joint_names])
        first, second = np.array(levers)[model.pairs.T]
        return np.linalg.norm(np.where((first == 0) != (second == 0), first + second, 0.0), axis=1)
