"""The commands of a keyboard node, 0.05 or 0.02 rad a key with a time_from_start of 0."""

from dataclasses import replace
from functools import partial

import pytest

from harness.core.resources import data_folder
from harness.plugins.ros.control.cell import TICK
from harness.plugins.ros.handover import ReplayControl
from harness.recording.commands import CommandRecord
from harness.session.run_case import run_case
from harness.session.run_request import RunRequest
from harness.session.start import start_simulated
from tests.plugins.ros.nodes import ARM

EXERCISE = data_folder("scenarios") / "ros2/01_lift_the_red_box.scenario.yaml"
ROWS = 10  # physics samples in a tick


class Keys:
    """The commands of pressed keys, at simulated times."""

    def __init__(self, step, interval):
        self.commands, self._step, self._interval, self._time = [], step, interval, 0.5
        self._arm, self._gripper = [0.0] * 4, 0.0

    def pause(self, seconds):
        self._time += seconds

    def turn(self, joint, angle):
        """Press the key of a joint until it is turned by an angle [rad]."""
        for _ in range(round(abs(angle) / self._step)):
            self._arm[joint] += self._step if angle > 0 else -self._step
            row = {"positions": list(self._arm), "velocities": [], "accelerations": []}
            points = [{"time": 0.0, **row}]
            self._put("trajectory", "arm", joint_names=list(ARM), stamp=0.0, points=points)
            self._time += self._interval

    def grip(self, step, count):
        for _ in range(count):
            self._gripper = min(0.019, max(-0.01, self._gripper + step))
            self._put("gripper", "gripper", position=self._gripper, max_effort=10.0)
            self._time += max(self._interval, 0.1)

    def _put(self, kind, name, **content):
        sample = round(self._time / TICK) * ROWS
        goal = f"{len(self.commands):032x}" if kind == "gripper" else ""
        record = CommandRecord(sample, self._time, kind, f"{name}_controller", goal, content, "")
        self.commands.append(record)


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("step", "interval"),
    [*((0.05, each) for each in (0.05, 0.06, 0.08, 0.1, 0.15, 0.2, 0.3)), (0.02, 0.03),
     (0.02, 0.05), (0.02, 0.1)],
)  # fmt: skip
def test_the_keyboard_node_s_steps_lift_the_red_box(step, interval):
    keys = Keys(step, interval)
    keys.grip(0.002, 10)
    keys.pause(1.0)
    for joint, angle in ((3, -0.67), (2, -0.195), (1, 0.87)):
        keys.turn(joint, angle)
    keys.pause(1.5)
    keys.grip(-0.002, 16)
    keys.pause(1.5)
    keys.turn(1, -0.6)

    def start(request, clock):
        started = start_simulated(request, clock)
        parts = started.prepared, started.simulator, keys.commands
        return replace(started, open_session=partial(ReplayControl, *parts))

    result = run_case(RunRequest(EXERCISE, page=False, stills=False), start=start)
    assert result.outcome == "passed", result.message
