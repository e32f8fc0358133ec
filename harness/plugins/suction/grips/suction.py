"""Grasps by suction cups: faces with room for the cups, and what keeps cups from holding."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from harness.cell.cell import Cell
from harness.cell.grip import Grip
from harness.cell.scope import At
from harness.core.errors import StepFailed
from harness.core.geometry import Box, Cylinder, Geometry, Sphere
from harness.core.pose_arrays import rotations_about
from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.core.world import WorldObject
from harness.recording.explanation import Explanation
from harness.robot.description import RobotDescription
from harness.robot.end_effector import Cup

STANDOFF = 0.0005
"""Between the rims and the face that they approach [m]: within every lip, and the planner sees that
nothing touches; suction draws the two together."""
MARGIN = 0.001  # Between a rim and the edge of its face [m]
TURNS = [np.pi / 4 * eighth for eighth in (0, 2, 1, 3, 4, 6, 5, 7)]  # about the normal of a face
UPRIGHT = 0.1  # Largest downward part of the normal of a face that is approached


@dataclass(frozen=True, eq=False)
class Face:
    """A flat face of an object, or where a curved one is touched.

    Attributes:
        frame: T_object_face: its z axis leaves the object, x and y lie in the face.
        half: Half of its sides along x and y [m]; both are the radius where it `is_round`.
        is_round: Whether it is a disc.
        bulge: The radius of the curvature across y, or in all directions where it `is_round`; inf
            for a flat face [m].
    """

    frame: SE3
    half: tuple[float, float]
    is_round: bool = False
    bulge: float = float("inf")

    def has_room(self, points: FloatArray, radius: float) -> bool:
        """Whether circles about points of the face (N, 2) lie within its edges."""
        room = np.array(self.half) - radius - MARGIN
        if self.is_round and np.isinf(self.bulge):
            return bool((np.linalg.norm(points, axis=1) <= room[0]).all())
        return bool((np.abs(points) <= room).all())


def faces_of(obj: WorldObject) -> Iterator[Face]:
    """Faces of boxes and cylinders, and the points where spheres are touched."""
    for shape in obj.shapes:
        for axis, half, size, is_round, bulge in _sides(shape.geometry):
            frame = shape.pose @ _frame(axis, size)
            yield Face(frame, half, is_round, bulge)


def _sides(
    geometry: Geometry,
) -> Iterator[tuple[FloatArray, tuple[float, float], float, bool, float]]:
    """Normal, half sides, distance from the middle, roundness and bulge of each side."""
    axes = np.eye(3)
    match geometry:
        case Box(size=size):
            for axis, sign in itertools.product((2, 0, 1), (1.0, -1.0)):
                # `_frame` has x and y along the next two axes
                along, across = ((1, 2), (2, 0), (0, 1))[axis]
                half = size[along] / 2, size[across] / 2
                yield sign * axes[axis], half, size[axis] / 2, False, np.inf
        case Cylinder(radius=radius, length=length):
            for sign in (1.0, -1.0):
                yield sign * axes[2], (radius, radius), length / 2, True, np.inf
            for axis, sign in itertools.product((0, 1), (1.0, -1.0)):
                half = (radius, length / 2) if axis == 0 else (length / 2, radius)
                yield sign * axes[axis], half, radius, False, radius
        case Sphere(radius=radius):
            for axis, sign in itertools.product((2, 0, 1), (1.0, -1.0)):
                yield sign * axes[axis], (radius, radius), radius, True, radius
        case _:
            return


def _frame(normal: FloatArray, distance: float) -> SE3:
    """A frame at a distance along an axis, with z along it and x, y along the next two axes."""
    axis = int(np.argmax(np.abs(normal)))
    sign = float(normal[axis])
    x = np.eye(3)[(axis + 1) % 3]
    rotation = np.array([x, np.cross(normal, x), normal], dtype=float).T
    return SE3(rotation, distance * sign * np.eye(3)[axis])


def cup_places(description: RobotDescription) -> FloatArray:
    """Where the middles of the rims are in the TCP's frame, shape (cups, 3) [m]."""
    gripper = description.gripper
    assert gripper is not None
    poses = description.link_poses(description.start_positions())
    to_tcp = poses[description.tcp_link].inverse()
    return np.array([(to_tcp @ poses[cup.link]).translation for cup in gripper.cups])


def why_not_held(
    obj: WorldObject, description: RobotDescription, gravity: float, *, by_all: bool
) -> str:
    """Why suction cups cannot hold an object; empty where they may, or its faces are unknown.

    Args:
        obj: The object with its mass.
        description: The robot with its suction cups.
        gravity: The gravitational acceleration [m/s^2].
        by_all: Whether all cups must be on one face, or only one of them.
    """
    gripper = description.gripper
    assert gripper is not None
    weight, most = obj.mass * gravity, gripper.holding_force
    if weight > most:
        return f"'{obj.name}' weighs {weight:.1f} N, and the suction cups hold at most {most:.1f} N"
    faces = list(faces_of(obj))
    places = cup_places(description)
    if not by_all:
        places = np.zeros((1, 3))
    if not faces or any(_turns(face, places, gripper.cups) for face in faces):
        return ""
    cup = max(gripper.cups, key=lambda each: each.radius)
    balls = [face for face in faces if face.is_round and np.isfinite(face.bulge)]
    if len(balls) == len(faces):
        least = max((cup.radius**2 + cup.depth**2) / (2 * cup.depth), cup.radius)
        if len(places) > 1 and balls[0].bulge >= least:
            return f"'{obj.name}' is a sphere, and {len(places)} suction cups do not close on one"
        return (
            f"'{obj.name}' is too small a sphere for the suction cup: its radius is"
            f" {1e3 * balls[0].bulge:.1f} mm, and a cup of {1e3 * cup.radius:.1f} mm needs"
            f" {1e3 * least:.1f} mm"
        )
    face = max(faces, key=lambda each: each.half[0] * each.half[1])
    extent = 2e3 * (np.ptp(places[:, :2], axis=0) / 2 + cup.radius + MARGIN)
    return (
        f"no face of '{obj.name}' has room for the suction cups: its largest is"
        f" {2e3 * face.half[0]:.1f} x {2e3 * face.half[1]:.1f} mm, and they need"
        f" {extent[0]:.1f} x {extent[1]:.1f} mm of a flat one"
    )


def _turns(face: Face, places: FloatArray, cups: Sequence[Cup]) -> list[tuple[float, float]]:
    """Turns about a face's normal [rad] for which every cup has room, and how deep it goes [m]."""
    radius, depth = max(cup.radius for cup in cups), min(cup.depth for cup in cups)
    sunk, bulge = 0.0, face.bulge
    if np.isfinite(bulge):
        if bulge <= radius or len(places) > 1:
            return []
        sunk = bulge - float(np.sqrt(bulge**2 - radius**2))
        if sunk > (depth if face.is_round else min(cup.lip for cup in cups)):
            return []
        if face.is_round:
            return [(turn, sunk) for turn in TURNS]
        sunk = 0.0
    return [
        (turn, sunk) for turn in TURNS if face.has_room((places @ _in_face(turn).T)[:, :2], radius)
    ]


def _in_face(turn: float) -> FloatArray:
    """R_face_tcp of a TCP that looks at a face, turned about its normal."""
    return rotations_about(np.array([0.0, 0.0, 1.0]), turn) @ np.diag([1.0, -1.0, -1.0])


class SuctionGrip(Grip):
    """Hold a face with room for all rims, or one of curvature that the cups close on."""

    name: ClassVar[str] = "suction"

    def check(self, obj: WorldObject | None, at: At, mode: str, *, by_all_cups: bool) -> None:
        description, gravity = at.scope.description, at.scope.gravity
        why = "" if obj is None else why_not_held(obj, description, gravity, by_all=by_all_cups)
        if why:
            hint = "take a smaller load, or a gripper with other cups"
            at.scope.problems.add(at.key("object"), why, hint)
        if mode == "weld":
            at.scope.problems.add(
                at.key("mode"),
                "suction cups hold by their vacuum alone: a weld would hold what they cannot",
                "leave out `mode`",
            )

    def grasps(self, obj: WorldObject, pose: SE3, cell: Cell) -> list[SE3]:
        faces, gripper = list(faces_of(obj)), cell.gripper
        if not faces:
            raise StepFailed(
                "INVALID_OBJECT_NAME",
                f"'{obj.name}' has no box, cylinder or sphere whose face the cups could hold",
                Explanation(advice="give a `grasp_pose`: the TCP's z axis points at the face"),
            )
        places = cup_places(cell.description)
        ups = {id(face): float((pose @ face.frame).rotation[2, 2]) for face in faces}
        highest = sorted(faces, key=lambda face: -round(ups[id(face)], 6))
        for level in sorted({round(up, 3) for up in ups.values()}, reverse=True):
            if level < -UPRIGHT:
                break
            grasps = [
                pose @ face.frame @ SE3(_in_face(turn), np.array([0.0, 0.0, STANDOFF - sunk]))
                for face in highest
                if round(ups[id(face)], 3) == level
                for turn, sunk in _turns(face, places, gripper.cups)
            ]
            if grasps:
                return grasps
        raise StepFailed(
            "GOAL_STATE_INVALID",
            f"no face of '{obj.name}' that looks up or to the side has room for the suction cups",
            Explanation(advice="give a `grasp_pose`, or take a gripper with smaller cups"),
        )

    def grasps_at(self, point: FloatArray) -> list[SE3]:
        return [SE3(_in_face(turn), point) for turn in TURNS]
