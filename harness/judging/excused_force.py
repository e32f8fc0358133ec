"""Forces and distances that excuse a contact of the hand, or of an object that it holds.

A contact that gripping, carrying or putting down excuses is one only while its force, on average
over `SPAN`, stays below `FACTOR` times what they explain, plus `SLACK`:

- a link of the hand presses what it grips with the grip that the gripper's motor exerts now, and
  with the weight of the object and of what rests on it;
- what the hand holds presses another body with that weight; while the gripper moves, also with the
  grip, since fingers that close on an object push it about;
- what leaves the body that it stood on when it was gripped presses that body with the grip too, for
  at most `LEAVE` in all: the fingers have pressed it down, and do until it is free.

The average is an impulse: contacts between stiff bodies peak at ten times the force of the grip for
a millisecond, and say nothing. In the bundled picks it reaches 1.1 times what is explained. What
the hand holds may stay in touch while it leaves its support or is put down, but not while it is
dragged along another body for `DRAG` or more.
"""

from __future__ import annotations

import numpy as np

from harness.core.pose_arrays import relative
from harness.core.types import BoolArray, FloatArray
from harness.judging.body_motion import middles
from harness.judging.contacts import force_between
from harness.judging.hands import each_hand, gripper_of
from harness.judging.hold import held_by_fingers, recent_mean, weight_of
from harness.judging.poses import object_poses
from harness.judging.support import riders
from harness.judging.window import NotObservable, object_record, put_samples
from harness.recording.run import Run

SPAN = 0.05  # [s], over which a force is averaged: longer than a blow, shorter than a motion
FACTOR = 2.0  # as `on` requires half of the weight: an object is accelerated with at most gravity's
SLACK = 1.0  # [N], what a position error of 0.1 mm presses with: the weight of 100 g
LEAVE = 2 * SPAN
"""How long an object that is lifted at once may still be pressed onto its support [s]: the averages
over the time before contain the grip for one `SPAN`, and the object leaves within another."""
DRAG = 0.02  # longer than contact points wander while an object is gripped, tilts and leaves [m]


def mean_force(run: Run, first: str, second: str) -> FloatArray:
    """Force between two bodies, mean of `SPAN` [N], shape (N,)."""
    return recent_mean(run, force_between(run, {first}, {second})[:, None], SPAN)[:, 0]


def load_of(run: Run, name: str) -> FloatArray:
    """Weight of an object and of what rests on it at each sample [N], shape (N,)."""
    load = np.full(len(run.signals.times), weight_of(run, name))
    for rider, rides in riders(run, name).items():
        load = load + np.where(rides, weight_of(run, rider), 0)
    return load


def grip_force(run: Run) -> FloatArray:
    """Force of a finger side as the effort of the gripper's joint explains it [N], shape (N,).

    By the work of a small motion: the effort times the joint's motion is the force times the change
    of the gap. It is not known (inf) where the gripper's widths are not. Of suction cups it is the
    force with which all of them hold.
    """
    hand = gripper_of(run)
    if hand.cups:
        return np.full(len(run.signals.times), hand.holding_force)
    rows = hand.widths[np.argsort(hand.widths[:, 0])]
    if len(rows) < 2:
        return np.full(len(run.signals.times), np.inf)
    column = run.robot.joint_index[hand.joint]
    middles = (rows[1:, 0] + rows[:-1, 0]) / 2
    slopes = np.abs(np.diff(rows[:, 1]) / np.diff(rows[:, 0]))
    slope = np.interp(run.signals.joint_positions[:, column], middles, slopes)
    force = np.abs(run.signals.joint_efforts[:, column]) / np.maximum(slope, 1e-9)
    return recent_mean(run, force[:, None], SPAN)[:, 0]


def holding_force(run: Run, name: str) -> FloatArray:
    """Largest force of a finger side of the grippers that hold an object [N], shape (N,).

    Of every gripper where none ever holds it with its fingers.
    """
    hands = each_hand(run)
    holding = [hand for hand in hands if held_by_fingers(hand, name).any()]
    return np.max([grip_force(hand) for hand in holding or hands], axis=0)


def hand_limit(run: Run, name: str) -> FloatArray:
    """Largest mean force with which a link of the hand presses what it grips [N], shape (N,)."""
    return FACTOR * (grip_force(run) + load_of(run, name)) + SLACK


def held_limit(run: Run, name: str, gripper_moves: BoolArray) -> FloatArray:
    """Largest mean force with which a held object presses another body [N], shape (N,).

    Args:
        gripper_moves: Samples of steps that move the gripper, shape (N,).
    """
    grip = np.where(gripper_moves, holding_force(run, name), 0.0)
    return FACTOR * (load_of(run, name) + grip) + SLACK


def leaving_limit(
    run: Run, name: str, samples: slice, force: FloatArray, limit: FloatArray
) -> FloatArray:
    """Largest mean force with which a held object presses what it leaves [N].

    Args:
        force: The mean force at these samples [N], shape (n,).
        limit: What `held_limit` says of these samples, shape (n,).
    """
    times = run.signals.times[samples]
    spent = np.cumsum(np.where(force > limit, np.diff(times, prepend=times[:1]), 0.0))
    return limit + np.where(spent <= LEAVE, holding_force(run, name)[samples], 0.0)


def dragged(run: Run, name: str, other: str, start: int, stop: int) -> FloatArray:
    """How far an object has slid along another since a sample [m], shape (stop - start,).

    The way of the points at which they touch counts: the ends of a ruler that turns where it lies
    are dragged, and a rod that is raised at one end is not. In the gaps of one contact it slides as
    before. Where that was not recorded it is how far the middle of the object has moved.
    """
    pair = (min(name, other), max(name, other))
    if pair in run.signals.slides:
        slid = run.signals.slides[pair].copy()
        slid[[*put_samples(run, name), *put_samples(run, other), start]] = 0.0
        slid[np.isnan(slid)] = DRAG  # as far as may be: what is not known excuses nothing
        touching = force_between(run, {name}, {other})[start:stop] > 0
        latest = np.maximum.accumulate(np.where(touching, np.arange(stop - start), 0))
        return np.cumsum(slid[start:stop][latest])
    poses = object_poses(run, name)[start:stop]
    try:
        seen = relative(object_poses(run, other)[start:stop], poses)
    except NotObservable:
        seen = poses
    places = middles(object_record(run, name), seen)
    return np.linalg.norm(places - places[0], axis=1)
