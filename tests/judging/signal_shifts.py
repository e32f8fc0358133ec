"""Signals shifted in every direction, for the mutation check."""

from dataclasses import replace

import numpy as np

from harness.core.pose_arrays import quat_product
from tests.judging.evidence import DRIFT

SIZES = (0.02, 0.3, 3.0, 30.0)
"""In the signal's own unit; of a pose m and rad."""
POSE_WIDTH = 7
COLUMNS = {
    POSE_WIDTH: ("x", "y", "z", "roll", "pitch", "yaw"),
    6: ("x", "y", "z", "force x", "force y", "force z"),
    3: ("x", "y", "z"),
    2: ("shoulder", "finger"),
    1: ("",),
}


def array_of(signals, place):
    """The array at a place (field, key)."""
    field, key = place
    return getattr(signals, field) if key is None else getattr(signals, field)[key]


def with_array(run, place, array):
    """The run with another array there."""
    field, key = place
    value = array if key is None else {**getattr(run.signals, field), key: array}
    return replace(run, signals=replace(run.signals, **{field: value}))


def directions(run, place):
    """Either way of each column: `+x`, `-x`, ..."""
    array = array_of(run.signals, place)
    width = 1 if array.ndim == 1 else array.shape[1]
    return [sign + column for column in COLUMNS[width] for sign in "+-"]


def shifted(run, place, start, direction, course, sizes=SIZES):
    """A mutant for each size, from the smallest: from the window's start on so much, or a second.

    A quaternion is turned about an axis of its own frame.
    """
    array = array_of(run.signals, place)
    rows = array.reshape(len(array), -1)
    column = COLUMNS[rows.shape[1]].index(direction[1:])
    seconds = run.signals.times[start:] - run.signals.times[start]
    share = seconds if course == DRIFT else np.ones(len(seconds))
    for size in sizes:
        amounts = (size if direction[0] == "+" else -size) * share
        moved = rows.copy()
        if rows.shape[1] == POSE_WIDTH and column >= 3:
            moved[start:, 3:] = _turned(rows[start:, 3:], column - 3, amounts)
        else:
            moved[start:, column] += amounts
        yield with_array(run, place, moved.reshape(array.shape))


def _turned(quats, axis, angles):
    """Quaternions (wxyz) turned about an axis of their own frame by angles [rad]."""
    turns = np.zeros((len(angles), 4))
    turns[:, 0], turns[:, 1 + axis] = np.cos(angles / 2), np.sin(angles / 2)
    return quat_product(quats, turns)
