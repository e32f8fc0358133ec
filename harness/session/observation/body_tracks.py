"""Poses of the bodies of a recorded run at every sample, and how far they move."""

# coal has no type stubs
# pyright: reportAttributeAccessIssue=false, reportMissingTypeStubs=false
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false
# pyright: reportUnknownArgumentType=false, reportUnknownParameterType=false

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import coal
import numpy as np

from harness.core.geometry import Shape
from harness.core.kinematics import LinkPoses
from harness.core.pose_arrays import rotations_of, times_each
from harness.core.spatial import rotation_from_quat_wxyz
from harness.core.types import BoolArray, FloatArray, IntArray
from harness.recording.motion import Motion
from harness.recording.run import AttachmentRecord, ObjectRecord
from harness.robot.solids import coal_geometry

LOOKS = 8  # samples from one at which the gaps of balls and boxes are computed to the next


@dataclass(frozen=True, eq=False)
class BodyTrack:
    """A rigid body over N samples.

    Attributes:
        rotations: The rotations of T_world_body, shape (N, 3, 3).
        translations: The translations of T_world_body [m], shape (N, 3); NaN while absent.
    """

    rotations: FloatArray
    translations: FloatArray

    @cached_property
    def turns(self) -> FloatArray:
        """Rotation angle between neighbouring samples [rad], shape (N - 1,)."""
        steps = np.diff(self.rotations, axis=0).reshape(-1, 9)
        chords = np.sqrt(np.einsum("ij,ij->i", steps, steps)) / (2 * np.sqrt(2))
        return 2 * np.arcsin(np.minimum(chords, 1.0))

    @property
    def present(self) -> BoolArray:
        """Samples with a pose, shape (N,)."""
        return np.isfinite(self.translations[:, 0])

    def part(self, samples: BoolArray | IntArray) -> BodyTrack:
        """The same body at some samples only."""
        if samples.dtype == bool and samples.all():
            return self
        return BodyTrack(self.rotations[samples], self.translations[samples])


def track_of_poses(poses: FloatArray) -> BodyTrack:
    """A track from recorded poses (N, 7), xyz and quat wxyz, NaN while absent."""
    return BodyTrack(rotations_of(poses[:, 3:]), np.array(poses[:, :3]))


def link_track(poses: LinkPoses, link: str) -> BodyTrack:
    """A link's track."""
    return BodyTrack(poses.rotations[link], poses.translations[link])


def carried_track(link: BodyTrack, pose_in_link: Sequence[float]) -> BodyTrack:
    """Track of something fixed to a link at T_link_object (xyz, quat wxyz)."""
    offset = np.asarray(pose_in_link, dtype=float)
    rotation = rotation_from_quat_wxyz(offset[3:])
    shift = times_each(link.rotations, offset[:3])
    return BodyTrack(times_each(link.rotations, rotation), link.translations + shift)


def object_track(
    record: ObjectRecord, attachments: Sequence[AttachmentRecord], motion: Motion, links: LinkPoses
) -> BodyTrack:
    """An object's track: as the physics recorded it, otherwise as the planning scene assumes it.

    An object of the planning scene alone stays where it is added, moves with the link to which it
    is attached, and stays where it is detached.
    """
    times = motion.times
    recorded = motion.object_poses.get(record.name)
    if recorded is not None:
        track = track_of_poses(np.asarray(recorded, dtype=float))
    else:
        count = len(times)
        poses = np.full((count, 7), np.nan)
        if record.pose:
            poses[:] = record.pose
        track = track_of_poses(poses)
        for held in sorted(attachments, key=lambda item: item.start_time):
            if held.object != record.name:
                continue
            carried = carried_track(link_track(links, held.link), held.pose_in_link)
            during = (times >= held.start_time) & (times <= held.end_time)
            track.rotations[during] = carried.rotations[during]
            track.translations[during] = carried.translations[during]
            if during.any():
                last = int(np.flatnonzero(during)[-1])
                track.rotations[last:] = carried.rotations[last]
                track.translations[last:] = carried.translations[last]
    there = np.zeros(len(times), dtype=bool)
    for start, end in record.present:
        there |= (times >= start) & (times <= end)
    track.translations[~there] = np.nan
    return track


@dataclass(frozen=True, eq=False)
class TrackedShape:
    """A collision shape of a body, with its bounding sphere.

    Attributes:
        geometry: The shape as Coal's geometry.
        pose: T_body_shape as Coal's transform.
        center: The bounding sphere's centre in the body frame [m].
        radius: The bounding sphere's radius [m]; inf for a half space.
        lower: The lower corner of the bounding box in the shape's frame [m]; -inf for a half space.
        upper: The upper corner of the bounding box in the shape's frame [m]; inf for a half space.
    """

    body: str
    geometry: coal.CollisionGeometry
    pose: coal.Transform3s
    center: FloatArray
    radius: float
    lower: FloatArray
    upper: FloatArray

    def gap(self, points: FloatArray) -> FloatArray:
        """Distance of points in the body frame, (N, 3, K), from the bounding box [m], (N, K)."""
        turned = self.pose.getRotation().T
        seen = turned @ points - (turned @ self.pose.getTranslation())[:, None]
        outside = seen - np.clip(seen, self.lower[:, None], self.upper[:, None])
        return np.sqrt(np.einsum("ijk,ijk->ik", outside, outside))


def tracked_shapes(body: str, shapes: Sequence[Shape]) -> tuple[TrackedShape, ...]:
    """Convert a body's shapes for distance measurements."""
    found = []
    for shape in shapes:
        geometry = coal_geometry(shape)
        geometry.computeLocalAABB()
        center = shape.pose.apply(np.array(geometry.aabb_center).reshape(3))
        found.append(
            TrackedShape(
                body,
                geometry,
                coal.Transform3s(shape.pose.rotation, shape.pose.translation),
                center,
                float(geometry.aabb_radius),
                np.array(geometry.aabb_local.min_).reshape(3),
                np.array(geometry.aabb_local.max_).reshape(3),
            )
        )
    return tuple(found)


def relative_track(first: BodyTrack, second: BodyTrack) -> BodyTrack:
    """Track of the first body in the frame of the second: T_second_first."""
    turned = np.swapaxes(second.rotations, 1, 2)
    offset = (first.translations - second.translations)[:, :, None]
    return BodyTrack(turned @ first.rotations, (turned @ offset)[:, :, 0])


def centers_of(seen: BodyTrack, shapes: Sequence[TrackedShape]) -> FloatArray:
    """The centres of the balls about shapes of a body along its track [m], shape (N, 3, shapes)."""
    centers = np.column_stack([shape.center for shape in shapes])
    return seen.translations[:, :, None] + times_each(seen.rotations, centers)


def travels(seen: BodyTrack, centers: FloatArray, radii: FloatArray) -> FloatArray:
    """Bound the path length of every point of shapes since the first sample [m], (N, shapes).

    Between two samples a point of a shape moves at most as far as the centre of its ball plus the
    ball's radius times the angle turned.

    Args:
        seen: The track of the shapes' body.
        centers: The centres of the balls, as `centers_of` returns them.
        radii: The radii of the balls [m], shape (shapes,).
    """
    steps = np.diff(centers, axis=0)
    shifts = np.sqrt(np.einsum("ijk,ijk->ik", steps, steps))
    moved = np.zeros((len(centers), len(radii)))
    np.cumsum(shifts + seen.turns[:, None] * radii, axis=0, out=moved[1:])
    return moved


@dataclass(frozen=True, eq=False)
class Looks:
    """Samples at which gaps are computed, and for how long each gap serves.

    Attributes:
        at: The samples of the looks, ascending, shape (looks,).
        counts: How many samples each serves, from its own on, shape (looks,).
        ends: The last samples before which they must hold: that of the next look, or the last one
            of the stretch, shape (looks,).
        follows: Whether each sample but the first is of the stretch before, shape (N - 1,).
    """

    at: IntArray
    counts: IntArray
    ends: IntArray
    follows: BoolArray

    @classmethod
    def of(cls, stretches: IntArray) -> Looks:
        """A look every `LOOKS` samples of each stretch.

        Args:
            stretches: The number of the stretch of each sample, ascending, shape (N,).
        """
        follows = np.diff(stretches) == 0
        begins = np.append(0, np.flatnonzero(~follows) + 1)
        place = np.arange(len(stretches)) - np.repeat(
            begins, np.diff(begins, append=len(stretches))
        )
        at = np.flatnonzero(place % LOOKS == 0)
        following = np.append(at[1:], len(stretches))
        return cls(at, following - at, following - np.append(place[at[1:]] == 0, True), follows)


@lru_cache(maxsize=16)
def _looks_at_one_stretch(count: int) -> Looks:
    return Looks.of(np.zeros(count, dtype=np.int64))


@dataclass(frozen=True, eq=False)
class MovingBody:
    """The shapes of a body, and where the body is at N samples.

    Attributes:
        track: T_world_body at every sample; absent at none.
        stretches: The number of the stretch of consecutive samples that each is in, ascending,
            shape (N,); None where all are one.
    """

    shapes: Sequence[TrackedShape]
    track: BodyTrack
    stretches: IntArray | None = None

    @cached_property
    def looks(self) -> Looks:
        """The looks at these samples."""
        if self.stretches is None:
            return _looks_at_one_stretch(len(self.track.translations))
        return Looks.of(self.stretches)

    @cached_property
    def radii(self) -> FloatArray:
        """The radii of the balls about the shapes [m], shape (shapes,)."""
        return np.array([shape.radius for shape in self.shapes])

    @cached_property
    def centers_at_looks(self) -> FloatArray:
        """The centres of these balls in the world, at every look [m], shape (looks, 3, shapes)."""
        return centers_of(self.track.part(self.looks.at), self.shapes)

    @cached_property
    def reach(self) -> FloatArray:
        """The most that a point of a shape moves until the next look [m], shape (looks,)."""
        return self.travelled[self.looks.ends] - self.travelled[self.looks.at]

    @cached_property
    def travelled(self) -> FloatArray:
        """Bound the path length of every point since the first sample [m], shape (N,)."""
        is_finite = np.isfinite(self.radii)
        centers = np.array([shape.center for shape in self.shapes])[is_finite]
        middle = centers.mean(axis=0) if len(centers) else np.zeros(3)
        radius = (np.linalg.norm(centers - middle, axis=1) + self.radii[is_finite]).max(initial=0.0)
        if not is_finite.all():
            radius = np.inf
        path = self.track.translations + times_each(self.track.rotations, middle)
        turns = self.track.turns
        turned = np.multiply(turns, radius, out=np.zeros_like(turns), where=turns > 0)
        moved = np.linalg.norm(np.diff(path, axis=0), axis=1) + turned
        return np.concatenate([[0.0], np.cumsum(moved)])

    def part(self, samples: BoolArray) -> MovingBody:
        if samples.all():
            return self
        stretches = None if self.stretches is None else self.stretches[samples]
        return MovingBody(self.shapes, self.track.part(samples), stretches)


def links_with_shapes(shapes: Mapping[str, Sequence[Shape]]) -> dict[str, tuple[TrackedShape, ...]]:
    """Tracked shapes of every link that has any."""
    return {link: tracked_shapes(link, each) for link, each in shapes.items() if each}
