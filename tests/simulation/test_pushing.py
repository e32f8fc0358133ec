"""A finger that pushes a box across the ground presses it with what friction needs."""

import numpy as np
import pytest

import harness

WEIGHT, FRICTION, MASS = 2 * 9.8, 0.4, 2.0
TOUCH = 50  # Samples of the first touch, which gives the box its momentum

SCENARIO = """
scenario: push
robot: {robot}
world: empty
objects:
  - {{name: crate, mass: 2, friction: 0.4, {crate}, pose: {{xyz: {at}}}}}
steps:
{steps}
  - allow_collisions:
      pairs: [[{pusher}, crate], [crate, ground_plane]]
      during: [{{lin: {{{goal}, cartesian_limits: {{max_trans_vel: {speed}}}}}, id: push}}]
"""
GANTRY = """
<mujoco>
  <worldbody>
    <body name="bridge" pos="0 0 0.5">
      <joint name="x" type="slide" axis="1 0 0" range="-0.1 0.6"/>
      <geom type="box" size="0.05 0.05 0.05" mass="3"/>
      <body name="carriage">
        <joint name="y" type="slide" axis="0 1 0" range="-0.4 0.4"/>
        <geom type="box" size="0.04 0.04 0.04" mass="2"/>
        <body name="quill" pos="0 0 -0.2">
          <joint name="z" type="slide" axis="0 0 1" range="-0.2 0.1"/>
          <geom type="capsule" size="0.015 0.15" mass="1"/>
          <site name="tip" pos="0 0 -0.15"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position joint="x" kp="1000" forcerange="-300 300"/>
    <position joint="y" kp="1000" forcerange="-300 300"/>
    <position joint="z" kp="1000" forcerange="-300 300"/>
  </actuator>
</mujoco>
"""
PUSHES = {
    "ur5e": {
        "pusher": "gripper",
        "robot": "{model: ur5e, gripper: rh_p12_rn_a}",
        "crate": "box: {size: [0.2, 0.2, 0.2]}",
        "at": "[0.5, 0.2, 0.1]",
        "steps": "  - gripper: close\n"
        "  - move_to: {pose: {xyz: [0.5, 0.03, 0.12], rpy: [180 deg, 0, 0]}}",
        "goal": "pose: {xyz: [0.5, 0.2, 0.12], rpy: [180 deg, 0, 0]}",
    },
    "open_manipulator_x": {
        "pusher": "gripper",
        "robot": "{model: open_manipulator_x, base: {xyz: [0, 0, 0.02]}}",
        "crate": "box: {size: [0.1, 0.2, 0.1]}",
        "at": "[0.31, 0, 0.05]",
        "steps": "  - gripper: close\n"
        "  - move_to: {position: {xyz: [0.2, 0, 0.07]}, pitch: 10 deg}",
        "goal": "position: {xyz: [0.3, 0, 0.07]}, pitch: 10 deg",
    },
    "gantry": {
        "pusher": "quill",
        "robot": "{mjcf: gantry.xml, tcp_link: tip}",
        "crate": "box: {size: [0.1, 0.2, 0.1]}",
        "at": "[0.2, 0, 0.05]",
        "steps": "  - move_to: {joints: {x: 0.1, y: 0, z: -0.1}}",
        "goal": "joints: {x: 0.3, y: 0, z: -0.1}",
    },
}
PUSHES["gantry on a slippery face"] = {
    **PUSHES["gantry"],
    "crate": "shapes: [{box: {size: [0.1, 0.2, 0.1]}}, {box: {size: [0.01, 0.2, 0.1]},"
    " pose: {xyz: [-0.051, 0, 0.001]}, friction: 0.001}]",
}


@pytest.fixture(scope="module")
def push_of(tmp_path_factory):
    """The run of a robot that pushes the box at a speed [m/s]."""
    known = {}

    def push(robot, speed):
        if (robot, speed) not in known:
            folder = tmp_path_factory.mktemp("push")
            (folder / "gantry.xml").write_text(GANTRY, encoding="utf-8")
            file = folder / "push.scenario.yaml"
            file.write_text(SCENARIO.format(speed=speed, **PUSHES[robot]), encoding="utf-8")
            result = harness.run(file)
            assert result, str(result)
            known[robot, speed] = result.run
        return known[robot, speed]

    return push


def force_on_crate(signals, *, of_ground):
    pairs = {pair: force for pair, force in signals.contact_forces.items() if "crate" in pair}
    return sum(force for pair, force in pairs.items() if ("ground_plane" in pair) == of_ground)


def steady(run):
    """The first sample of the push, and the samples at its full speed after the first touch."""
    finger = force_on_crate(run.signals, of_ground=False)
    first = int(np.argmax(finger > 0))
    speed = np.linalg.norm(np.diff(run.signals.tcp_pose[:, :3], axis=0), axis=1) / run.timestep
    window = 40
    smooth = np.convolve(speed, np.ones(window) / window, "same")
    full = np.median(smooth[first : first + 4 * TOUCH])
    slower = np.flatnonzero(smooth[first + TOUCH + window :] < 0.98 * full)
    return first, slice(first + TOUCH, first + TOUCH + int(slower[0]))


STICKING = ["open_manipulator_x", "ur5e", "gantry"]
ALL = [(robot, speed) for robot in STICKING for speed in (0.01, 0.05, 0.1)]
CHEAP = {"open_manipulator_x-0.1", "gantry-0.1"}


@pytest.mark.nightly(but=CHEAP)
@pytest.mark.parametrize(("robot", "speed"), ALL)
def test_a_push_presses_with_what_friction_needs(push_of, robot, speed):
    run = push_of(robot, speed)
    _, at_speed = steady(run)
    finger = force_on_crate(run.signals, of_ground=False)[at_speed]
    ground = force_on_crate(run.signals, of_ground=True)[at_speed]
    assert len(finger) > 300
    assert np.abs(finger - finger.mean()).max() < 0.2 * finger.mean()
    lasting = np.ones(10) / 10  # limits of forces are compared with means over 10 ms
    needed = FRICTION * np.convolve(ground, lasting, "valid")
    assert np.convolve(finger, lasting, "valid") == pytest.approx(needed, rel=0.1)
    assert finger.mean() == pytest.approx(FRICTION * ground.mean(), rel=0.01)
    # The finger sticks to the box since the first touch, and presses it down or lifts it a little.
    assert ground.mean() == pytest.approx(WEIGHT, rel=0.15)


@pytest.mark.nightly
def test_a_finger_that_does_not_stick_presses_with_what_the_weight_alone_needs(push_of):
    """What sticks keeps the box from rising by 0.05 mm as it begins to slide: it presses it down.

    This is the whole difference: with a slippery face the force is 7.84 N from sample to sample.
    """
    run = push_of("gantry on a slippery face", 0.1)
    _, at_speed = steady(run)
    finger = force_on_crate(run.signals, of_ground=False)[at_speed]
    assert len(finger) > 300
    assert finger == pytest.approx(np.full(len(finger), FRICTION * WEIGHT), rel=0.01)
    held = force_on_crate(push_of("gantry", 0.1).signals, of_ground=False)
    assert held[steady(push_of("gantry", 0.1))[1]].mean() > 1.05 * FRICTION * WEIGHT


@pytest.mark.nightly(but=CHEAP)
@pytest.mark.parametrize(("robot", "speed"), ALL)
def test_a_first_touch_gives_the_box_its_momentum_and_no_more(push_of, robot, speed):
    run = push_of(robot, speed)
    first, _ = steady(run)
    crate = run.signals.object_poses["crate"][first : first + TOUCH, :3]
    velocity = np.diff(crate, axis=0) / run.timestep
    finger = force_on_crate(run.signals, of_ground=False)[first : first + TOUCH - 1]
    ground = force_on_crate(run.signals, of_ground=True)[first : first + TOUCH - 1]
    assert np.linalg.norm(velocity, axis=1).max() < 1.25 * speed  # it hardly bounces
    taken_by_friction = FRICTION * ground.sum() * run.timestep
    momentum = MASS * np.linalg.norm(velocity[-1])
    impulse = finger.sum() * run.timestep
    assert impulse == pytest.approx(momentum + taken_by_friction, rel=0.05)
