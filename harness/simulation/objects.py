"""Makes prepared objects appear, move, disappear and be welded in a running simulation."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import mujoco
import numpy as np

from harness.core.spatial import SE3
from harness.core.types import FloatArray
from harness.ports.scene import Touch
from harness.simulation.model import ObjectPlace, PhysicsModel, set_presence
from harness.simulation.recording import Recording
from harness.simulation.step_state import wake
from harness.simulation.world_mjcf import weld_name

SMALLEST_OVERLAP = 1e-4  # Depth above which two bodies overlap; resting objects penetrate less [m]


class Objects:
    """The presence and poses of objects, with the history that reconstructs every sample.

    Attributes:
        log: Since which samples each object stands where it was put; None: it is absent.
    """

    def __init__(
        self,
        physics: PhysicsModel,
        data: mujoco.MjData,
        recording: Recording,
        present: frozenset[str],
    ) -> None:
        self._physics = physics
        self._data = data
        self._recording = recording
        self.log: dict[str, list[tuple[int, FloatArray | None]]] = {
            name: [(0, self._pose(place) if name in present else None)]
            for name, place in physics.objects.items()
        }

    def pose(self, name: str) -> SE3:
        """The current T_world_object."""
        return SE3.from_vector(self._pose(self._physics.objects[name]))

    def add(self, name: str, pose: SE3) -> None:
        """Make a parked object appear, at rest."""
        set_presence(self._physics.model, self._physics.objects[name], present=True)
        self.move(name, pose)

    def remove(self, name: str) -> None:
        """Park an object without contacts and weight."""
        self.unweld(name)
        set_presence(self._physics.model, self._physics.objects[name], present=False)
        self._place(name, self._physics.objects[name].parking)
        self.log[name].append((self._recording.count, None))

    def move(self, name: str, pose: SE3) -> None:
        """Place an object at T_world_object, at rest."""
        self.unweld(name)
        self._place(name, pose.as_vector())
        self.log[name].append((self._recording.count, pose.as_vector()))

    def weld(self, name: str, link: str) -> None:
        """Fix a free object to a link at their current poses."""
        model, data = self._physics.model, self._data
        wake(model, data)
        link_body, object_body = model.body(link).id, self._physics.objects[name].body
        T_world_link = SE3.from_xyz_quat(data.xpos[link_body], data.xquat[link_body])
        T_world_object = SE3.from_xyz_quat(data.xpos[object_body], data.xquat[object_body])
        weld = model.equality(weld_name(name)).id
        model.eq_obj1id[weld] = link_body
        model.eq_data[weld, :3] = 0.0
        model.eq_data[weld, 3:10] = (T_world_link.inverse() @ T_world_object).as_vector()
        data.eq_active[weld] = 1

    def unweld(self, name: str) -> None:
        """Release a welded object; an object that is not welded does not change."""
        if self._physics.objects[name].obj.is_static:
            return
        weld = self._physics.model.equality(weld_name(name)).id
        if self._data.eq_active[weld]:
            self._data.eq_active[weld] = 0
            wake(self._physics.model, self._data)

    def recorded_poses(self, first: int = 0) -> dict[str, FloatArray]:
        """T_world_object of every sample from one on, NaN while absent, shape (N, 7) each."""
        count = self._recording.count
        poses: dict[str, FloatArray] = {}
        for name, place in self._physics.objects.items():
            log = self.log[name]
            moves = place.qpos >= 0
            rows = self._recording.poses(place, first) if moves else np.empty((count - first, 7))
            for (begin, pose), (end, _) in zip(log, [*log[1:], (count, None)], strict=True):
                during = slice(max(0, begin - first), max(0, end - first))
                if pose is None:
                    rows[during] = np.nan
                elif not moves:
                    rows[during] = pose
            poses[name] = rows
        return poses

    def present_poses(self) -> dict[str, FloatArray]:
        """T_world_object of the objects in the scene now, shape (7,) each."""
        return {
            name: self._pose(place)
            for name, place in self._physics.objects.items()
            if self.log[name][-1][1] is not None
        }

    def _pose(self, place: ObjectPlace) -> FloatArray:
        if place.obj.joint is not None:
            return place.obj.joint.pose(float(self._data.qpos[place.qpos])).as_vector()
        if place.qpos >= 0:
            return self._data.qpos[place.qpos : place.qpos + 7].copy()
        model = self._physics.model
        return np.concatenate([model.body_pos[place.body], model.body_quat[place.body]])

    def _place(self, name: str, pose: FloatArray) -> None:
        place = self._physics.objects[name]
        if place.obj.joint is not None:
            self._data.qpos[place.qpos] = place.obj.joint.position(SE3.from_vector(pose))
            self._data.qvel[place.dof] = self._data.qacc_warmstart[place.dof] = 0.0
        elif place.qpos >= 0:
            self._data.qpos[place.qpos : place.qpos + 7] = pose
            self._data.qvel[place.dof : place.dof + 6] = 0.0
            self._data.qacc_warmstart[place.dof : place.dof + 6] = 0.0
        else:
            self._physics.model.body_pos[place.body] = pose[:3]
            self._physics.model.body_quat[place.body] = pose[3:]
        wake(self._physics.model, self._data)


def overlaps(physics: PhysicsModel, data: mujoco.MjData) -> tuple[Touch, ...]:
    """Find pairs of an object and another body that overlap, deepest first."""
    names, robot = physics.body_names, physics.robot_bodies
    deepest: dict[tuple[str, str], float] = {}
    bodies = physics.model.geom_bodyid[data.contact.geom].tolist()
    for (first, second), distance in zip(bodies, data.contact.dist.tolist(), strict=True):
        if distance > -SMALLEST_OVERLAP or (first in robot and second in robot):
            continue
        pair = sorted((first, second), key=lambda body: (body not in robot, names[body]))
        key = names[pair[0]], names[pair[1]]
        deepest[key] = min(distance, deepest.get(key, 0.0))
    found = [Touch(*pair, distance) for pair, distance in deepest.items()]
    return tuple(sorted(found, key=lambda touch: (touch.distance, touch.first, touch.second)))
