"""What the tool, objects and contacts did, for the plots."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from harness.core.pose_arrays import compose, turn_between
from harness.core.types import FloatArray, Pair
from harness.judging.body_motion import lowest_points
from harness.recording.link_poses import replayed_link_poses, tcp_tracks
from harness.recording.run import Run
from harness.recording.touched import touched_objects
from harness.reporting.html.plot_group import MOST_SERIES, Group

MOST_SENSORS = 3  # of four series each in one plot


def clearances(run: Run) -> Group:
    """The pairs that came nearest."""
    series = _nearest(run, run.signals.clearances)
    return Group("clearance", "clearance", "mm", series, measure="clearance", factor=1e3)


def planned_clearances(run: Run) -> Group:
    """The same, had the arm been at its commands."""
    series = _nearest(run, run.signals.planned_clearances)
    return Group("planned_clearance", "clearance of the commands", "mm", series)


def _nearest(run: Run, clearances: Mapping[Pair, FloatArray]) -> dict[str, FloatArray]:
    """Pairs by how near they came; those never nearer than the observer looks are left out."""
    lowest = {
        pair: float(np.nanmin(values))
        for pair, values in clearances.items()
        if np.isfinite(values).any()
    }
    seen = [pair for pair in lowest if lowest[pair] < run.signals.clearance_cutoff - 1e-9]
    nearest = sorted(seen, key=lambda pair: (lowest[pair], pair))[:MOST_SERIES]
    return {_pair_name(pair): 1e3 * clearances[pair] for pair in nearest}


def _pair_name(pair: tuple[str, str]) -> str:
    return f"{pair[0]} and itself" if pair[0] == pair[1] else f"{pair[0]} and {pair[1]}"


def contacts(run: Run) -> Group:
    """Forces between bodies; the robot's first, then the hardest."""
    links = set(run.robot.link_names)
    peaks = {pair: float(np.max(force)) for pair, force in run.signals.contact_forces.items()}
    order = sorted(peaks, key=lambda pair: (not links & set(pair), -peaks[pair], pair))
    series = {
        _pair_name(pair): run.signals.contact_forces[pair]
        for pair in order[:MOST_SERIES]
        if peaks[pair] > 0
    }
    return Group("contact", "contact force", "N", series, least=0.1)


def forces(run: Run) -> Group:
    """Forces that sensors between links read, in their axes."""
    return _read(run, "wrench_force", "wrist force", "N", 0)


def torques(run: Run) -> Group:
    """Torques that sensors between links read, in their axes."""
    return _read(run, "wrench_torque", "wrist torque", "N m", 3)


def _read(run: Run, name: str, title: str, unit: str, first: int) -> Group:
    """Three components of the readings of every sensor, and their magnitude."""
    series: dict[str, FloatArray] = {}
    for sensor, rows in list(run.signals.wrenches.items())[:MOST_SENSORS]:
        vector = rows[:, first : first + 3]
        series |= {f"{sensor} {axis}": vector[:, i] for i, axis in enumerate("xyz")}
        series[f"{sensor} magnitude"] = np.linalg.norm(vector, axis=1)
    return Group(name, title, unit, series, least=0.1, measure=title, is_signed=True)


def surfaces(run: Run) -> Group:
    """How the surfaces of belts move, along their x axes."""
    series = {belt: rows[:, 0] for belt, rows in run.signals.surfaces.items()}
    return Group("surface", "belt velocity", "m/s", series, least=0.01)


def slip(run: Run) -> Group:
    """How far a held object is from where the planner believes it to be."""
    times = run.signals.times
    series: dict[str, FloatArray] = {}
    for held in run.attachments:
        actual = run.signals.object_poses.get(held.represents)
        if actual is None or held.link not in run.robot.link_names:
            continue
        rows = np.flatnonzero((times >= held.start_time) & (times <= held.end_time))
        if not len(rows):
            continue
        carrier = replayed_link_poses(run.robot, run.signals.joint_positions[rows], [held.link])[
            held.link
        ]
        believed = compose(carrier, np.array(held.pose_in_link))
        distance = np.full(len(times), np.nan)
        distance[rows] = 1e3 * np.linalg.norm(actual[rows, :3] - believed[:, :3], axis=1)
        stands_for = "" if held.object == held.represents else f" ({held.represents})"
        name = held.object + stands_for
        series[name] = np.fmax(series[name], distance) if name in series else distance
    title = "held object, off its plan"
    return Group("slip", title, "mm", series, least=0.1, measure="slip in the hand", factor=1e3)


def tcp_position(run: Run) -> Group:
    """Where the tool was."""
    series = {
        f"{arm} {axis}".strip(): 1e3 * poses[:, i]
        for arm, poses in tcp_tracks(run).items()
        for i, axis in enumerate("xyz")
    }
    return Group("tcp", "TCP position in world", "mm", series)


def tcp_speed(run: Run) -> Group | None:
    """How fast the tool moved."""
    times = run.signals.times
    if len(times) < 3:
        return None
    series = {
        f"{arm} speed".strip(): 1e3
        * np.linalg.norm(np.gradient(poses[:, :3], times, axis=0), axis=1)
        for arm, poses in tcp_tracks(run).items()
    }
    return Group("tcp_speed", "TCP speed", "mm/s", series)


def _moving(run: Run) -> dict[str, FloatArray]:
    """Simulated objects that moved or that the robot touched, those that moved most first."""
    found, touched = dict[str, tuple[float, FloatArray]](), touched_objects(run)
    for obj in run.objects:
        poses = run.signals.object_poses.get(obj.name)
        if poses is None or obj.is_static or not obj.in_simulation:
            continue
        known = poses[np.isfinite(poses[:, 0]), :3]
        travel = max(float(np.ptp(axis)) for axis in known.T) if len(known) else 0.0
        if travel > 1e-3 or obj.name in touched:
            found[obj.name] = (travel, poses)
    order = sorted(found, key=lambda name: (-found[name][0], name))[:MOST_SERIES]
    return {name: found[name][1] for name in order}


def heights(run: Run) -> Group:
    """How far the lowest points of objects rose since they appeared or were put: as judged."""
    series, records = dict[str, FloatArray](), {obj.name: obj for obj in run.objects}
    for name, poses in _moving(run).items():
        lowest = 1e3 * lowest_points(records[name], poses)
        begins = np.diff(np.isfinite(lowest).astype(np.int8), prepend=0) > 0
        begins[records[name].put_samples(run.signals.times)] = True
        start = np.maximum.accumulate(np.where(begins, np.arange(len(lowest)), 0))
        series[name] = lowest - lowest[start]
    title = "rise of the lowest point"
    return Group("height", title, "mm", series, measure="height gained", factor=1e3)


def displacements(run: Run) -> Group:
    """How far objects are from where they stood first."""
    series = {
        name: 1e3 * np.linalg.norm(poses[:, :3] - _first(poses)[:3], axis=1)
        for name, poses in _moving(run).items()
    }
    return Group("displacement", "object displacement", "mm", series)


def _first(poses: FloatArray) -> FloatArray:
    return poses[int(np.isfinite(poses[:, 0]).argmax())]


def tcp_turn(run: Run) -> Group:
    """How far the tool has turned from its orientation at the begin."""
    series = {
        f"{arm} turn".strip(): _turned(poses[:, 3:], poses[0, 3:])
        for arm, poses in tcp_tracks(run).items()
    }
    return Group("tcp_turn", "TCP orientation, turned from the start", "°", series)


def turns(run: Run) -> Group:
    """How far objects have turned from how they stood first."""
    series = {
        name: _turned(poses[:, 3:], _first(poses)[3:]) for name, poses in _moving(run).items()
    }
    return Group("turn", "object turned from the start", "°", series)


def _turned(quats: FloatArray, first: FloatArray) -> FloatArray:
    """Angle of orientations from one of them [deg]."""
    return np.rad2deg(turn_between(first, quats))


def frame_travel(run: Run) -> Group:
    """How far links that expectations observe are from where they began."""
    series = {
        name: 1e3 * np.linalg.norm(poses[:, :3] - poses[0, :3], axis=1)
        for name, poses in list(run.signals.frames.items())[:MOST_SERIES]
    }
    return Group("frame", "observed link, from the start", "mm", series)
