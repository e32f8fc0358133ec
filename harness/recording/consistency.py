"""Whether the parts of a saved run fit each other: shapes of arrays, indices, and names."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields
from itertools import chain

import numpy as np

from harness.core.camera import Camera
from harness.core.geometry import Mesh
from harness.core.trajectory import JointTrajectory
from harness.core.types import FloatArray
from harness.recording.arrays import BY_NAME, BY_PAIR
from harness.recording.drawings import MeshRecord
from harness.recording.npz_file import ArrayHeader
from harness.recording.run import ObjectRecord, Run
from harness.recording.signals import Signals, VideoRecord
from harness.recording.step_record import StepRecord
from harness.robot.description import RobotDescription

Inconsistency = tuple[str, str]  # key, and what is wrong there
COLUMNS = {
    **{"tcp_pose": 7, "frames": 7, "object_poses": 7, "wrenches": 6},
    **{"presses": 6, "frictions": 3, "pulls": 4, "surfaces": 4},
}
"""Numbers per sample; the joint signals have one per joint, others one."""
PER_SAMPLE = tuple(
    entry.name
    for entry in fields(Signals)
    if entry.name not in (*BY_NAME, *BY_PAIR, "clearance_cutoff")
)
"""Signals that every run has."""
MESH_ARRAYS = {"vertices": "float32", "faces": "int32"}
TABLES = tuple(entry.name for entry in fields(JointTrajectory) if entry.name != "joint_names")
"""The arrays of a trajectory."""


@dataclass(frozen=True)
class ExpectedArray:
    """What an array should be."""

    shape: tuple[int, ...]
    kind: str

    def flaw(self, name: str, header: ArrayHeader) -> Iterator[Inconsistency]:
        """What a header has against it."""
        if header.dtype != np.dtype(self.kind):
            yield name, f"expected {np.dtype(self.kind)}, found {header.dtype}"
        elif header.shape != self.shape:
            yield name, f"expected the shape {self.shape}, found {header.shape}"


def signal_flaws(
    headers: Mapping[str, ArrayHeader], robot: RobotDescription
) -> Iterator[Inconsistency]:
    """What is wrong with the headers of a run's signals."""
    for name in PER_SAMPLE:
        if name not in headers:
            yield name, "this array is missing"
    times = headers.get("times")
    if times is None:
        return
    if len(times.shape) != 1 or not times.shape[0]:
        yield "times", f"expected the shape (samples,), found {times.shape}"
        return
    count = times.shape[0]
    for name, header in headers.items():
        group = name.partition("/")[0]
        if group in (*PER_SAMPLE, *BY_NAME, *BY_PAIR):
            yield from _expected(group, count, len(robot.joint_names)).flaw(name, header)


def _expected(group: str, samples: int, joints: int) -> ExpectedArray:
    if group == "clearance_links":
        return ExpectedArray((samples,), "int64")
    columns = joints if group.startswith("joint_") else COLUMNS.get(group)
    return ExpectedArray((samples,) if columns is None else (samples, columns), "float64")


def run_flaws(run: Run) -> Iterator[Inconsistency]:
    """What in a run refers to something that is not there, or has a length of its own."""
    times = run.signals.times
    if not np.isfinite(times).all() or (np.diff(times) <= 0).any():
        yield "times", "expected finite times that rise"
    links = len(run.robot.link_names)
    for (first, second), nearest in run.signals.clearance_links.items():
        if nearest.size and (nearest.min() < -1 or nearest.max() >= links):
            yield f"clearance_links/{first}|{second}", f"expected indices from -1 to {links - 1}"
    yield from _robot_flaws(run.robot)
    for index, record in enumerate(run.objects):
        if record.pose:
            yield from _shape(f"objects[{index}].pose", np.array(record.pose), 7)
        yield from _hull_flaws(f"objects[{index}]", record)
    for index, record in enumerate(run.attachments):
        yield from _shape(f"attachments[{index}].pose_in_link", np.array(record.pose_in_link), 7)
    for index, step in enumerate(run.steps):
        yield from _step_flaws(f"steps[{index}]", step, len(times))
    yield from _camera_flaws(run)


def _hull_flaws(key: str, record: ObjectRecord) -> Iterator[Inconsistency]:
    for number, shape in enumerate(record.shapes):
        hull = shape.geometry.hull if isinstance(shape.geometry, Mesh) else None
        if hull is None:
            continue
        numbers = [*chain(*hull.corners), *hull.centroid, hull.thickness]
        if not hull.corners or not np.isfinite(numbers).all() or not 0 < hull.volume < np.inf:
            yield (
                f"{key}.shapes[{number}].geometry.hull",
                "expected corners, a volume above 0 and finite numbers",
            )


def _robot_flaws(robot: RobotDescription) -> Iterator[Inconsistency]:
    links, later = set(robot.link_names), {joint.child for joint in robot.joints}
    for index, joint in enumerate(robot.joints):
        key = f"robot.joints[{index}]"
        yield from _shape(f"{key}.axis", joint.axis, 3)
        yield from _shape(f"{key}.pose.xyz", joint.pose.translation, 3)
        yield from _unknown(f"{key}.parent", [joint.parent], links, "link")
        yield from _unknown(f"{key}.child", [joint.child], links, "link")
        if joint.parent in later:
            yield f"{key}.parent", f"expected a link that is placed before '{joint.child}'"
        later.discard(joint.child)
        if joint.mimic is not None:
            followed = [joint.mimic.joint]
            yield from _unknown(f"{key}.mimic.joint", followed, robot.joint_names, "joint")
    for name, group in robot.groups.items():
        yield from _unknown(f"robot.groups.{name}", group.joint_names, robot.joint_names, "joint")
    if robot.arm_group:
        yield from _unknown("robot.arm_group", [robot.arm_group], robot.groups, "group")
    hand = robot.gripper
    if hand is not None:
        yield from _unknown("robot.gripper.joint", [hand.joint], robot.joint_names, "joint")
        yield from _unknown("robot.gripper.group", [hand.group], robot.groups, "group")
        if len(hand.widths):
            yield from _shape("robot.gripper.widths", hand.widths, len(hand.widths), 2)


def _shape(key: str, array: FloatArray, *shape: int) -> Iterator[Inconsistency]:
    if array.shape != shape:
        yield key, f"expected the shape {shape}, found {array.shape}"
    elif not np.isfinite(array).all():
        yield key, "expected finite numbers"


def _step_flaws(key: str, step: StepRecord, samples: int) -> Iterator[Inconsistency]:
    if not 0 <= step.start_index <= step.end_index <= samples:
        span = f"{step.start_index} to {step.end_index}"
        yield f"{key}.start_index", f"expected indices within 0 to {samples}, found {span}"
    if not np.isfinite([step.start_time, step.end_time]).all():
        yield f"{key}.start_time", "expected finite times"
    if step.trajectory is not None:
        yield from _trajectory_flaws(f"{key}.trajectory", step.trajectory)


def _trajectory_flaws(key: str, trajectory: JointTrajectory) -> Iterator[Inconsistency]:
    if trajectory.times.ndim != 1 or not trajectory.times.size:
        yield f"{key}.times", "expected an array of one time per waypoint"
        return
    shape = (trajectory.times.size, len(trajectory.joint_names))
    for name in TABLES:
        array = getattr(trajectory, name)
        expected = ExpectedArray(shape[:1] if name == "times" else shape, "float64")
        yield from expected.flaw(f"{key}.{name}", ArrayHeader(array.shape, array.dtype))
        if array.dtype.kind == "f" and not np.isfinite(array).all():
            yield f"{key}.{name}", "expected finite numbers"


def _camera_flaws(run: Run) -> Iterator[Inconsistency]:
    cameras, samples = {camera.name for camera in run.cameras}, len(run.signals.times)
    for index, capture in enumerate(run.captures):
        key = f"captures[{index}]"
        yield from _unknown(f"{key}.camera", [capture.camera], cameras, "camera")
        if capture.pose:
            yield from _shape(f"{key}.pose", np.array(capture.pose), 7)
        if not 0 <= capture.sample < samples:
            yield f"{key}.sample", f"expected an index below {samples}, found {capture.sample}"


def video_flaws(
    videos: Iterable[VideoRecord], cameras: Iterable[Camera]
) -> Iterator[Inconsistency]:
    """Videos of cameras that are not there."""
    known = {camera.name for camera in cameras}
    for index, video in enumerate(videos):
        yield from _unknown(f"videos[{index}].camera", [video.camera], known, "camera")


def mesh_header_flaws(headers: Mapping[str, ArrayHeader], count: int) -> Iterator[Inconsistency]:
    """What is wrong with the headers of the triangles of so many meshes."""
    for index in range(count):
        for name, kind in MESH_ARRAYS.items():
            name = f"meshes/{index}/{name}"
            header = headers.get(name)
            if header is None:
                yield name, "this array is missing"
            else:
                yield from ExpectedArray((*header.shape[:1], 3), kind).flaw(name, header)


def mesh_flaws(meshes: Iterable[MeshRecord]) -> Iterator[Inconsistency]:
    """Faces that name vertices which are not there."""
    for index, mesh in enumerate(meshes):
        if mesh.faces.size and not 0 <= mesh.faces.min() <= mesh.faces.max() < len(mesh.vertices):
            yield f"meshes/{index}/faces", f"expected indices below {len(mesh.vertices)}"
        if not np.isfinite(mesh.vertices).all():
            yield f"meshes/{index}/vertices", "expected finite numbers"


def _unknown(
    key: str, names: Iterable[str], known: Iterable[str], what: str
) -> Iterator[Inconsistency]:
    for name in names:
        if name not in known:
            yield key, f"there is no {what} '{name}' in this run"
