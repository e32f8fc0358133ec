"""Several commands in one update of the controllers have the effect of the last one."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from harness.plugins.ros.handover import ReplayControl
from harness.recording.commands import CommandRecord
from harness.recording.read_run import read_run
from harness.session.run_case import run_case
from harness.session.run_request import RunRequest
from harness.session.start import start_simulated
from tests.plugins.ros.bridging import scenario
from tests.plugins.ros.nodes import ARM

ARM_CONTROLLER, GRIPPER_CONTROLLER = "arm_controller", "gripper_controller"
SAMPLE, TIME = 200, 0.2  # at which all commands take effect


def command(place, controller, seconds, *positions):
    names = ARM if controller == ARM_CONTROLLER else ["gripper_left_joint"]
    row = {"positions": [*positions], "velocities": [], "accelerations": []}
    content = {"joint_names": [*names], "stamp": 0.0, "points": [{"time": seconds, **row}]}
    goal = f"{place:032x}"
    return CommandRecord(SAMPLE, TIME, "trajectory", controller, goal, content)


def positions_after(folder, commands):
    """The joint positions of a run with these commands, shape (N, dof)."""
    records = [command(place, *each) for place, each in enumerate(commands)]

    def start(request, clock):
        started = start_simulated(request, clock)
        parts = started.prepared, started.simulator, records
        return replace(started, open_session=partial(ReplayControl, *parts))

    folder.mkdir()
    file = scenario(folder, "- external: {}\n  timeout: 1 s")
    request = RunRequest(file, report_dir=folder / "run", page=False, stills=False)
    run_case(request, start=start)
    return read_run(folder / "run").run.signals.joint_positions


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(
    "commands",
    [
        [(ARM_CONTROLLER, 0.0, angle, 0.0, 0.0, 0.0) for angle in (0.02, 0.04, 0.06)],
        [(ARM_CONTROLLER, 0.0, 0.0, *(3 * [angle])) for angle in (0.1, 0.2, 0.05)],
        [(GRIPPER_CONTROLLER, 0.0, width) for width in (0.004, 0.002, 0.006)],
    ],
)
def test_steps_at_once_move_the_arm_as_the_last_one_alone(tmp_path, commands):
    all_, last = (
        positions_after(tmp_path / name, each)
        for name, each in (("all", commands), ("last", commands[-1:]))
    )
    assert np.abs(last - last[0]).max() > 1e-3
    assert np.abs(all_ - last).max() < 1e-6


def test_a_motion_that_follows_a_step_at_once_begins_at_the_step(tmp_path):
    step, on = (ARM_CONTROLLER, 0.0, 0.1, 0.0, 0.0, 0.0), (ARM_CONTROLLER, 0.5, 0.1, 0.0, 0.0, 0.0)
    both, alone = (
        positions_after(tmp_path / name, each)
        for name, each in (("both", [step, on]), ("alone", [step]))
    )
    assert np.abs(both - alone).max() < 1e-6
