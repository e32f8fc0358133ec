"""The compiled physics: robot, servos, objects, sensors, and their indices in MuJoCo's arrays."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from harness.core.types import FloatArray, IntArray
from harness.core.world import WorldObject
from harness.robot.collision_shapes import convex_shapes
from harness.robot.description import RobotDescription
from harness.simulation.compiling import compile_model, refuse_unusable_masses
from harness.simulation.geoms import (
    CONTACT_DIMENSIONS,
    STIFF_SOLIMP,
    STIFF_SOLREF,
    roughness,
    set_smaller_frictions,
)
from harness.simulation.independence import make_independent
from harness.simulation.robot_mjcf import add_robot, link_friction
from harness.simulation.servo import Servos, add_servos, design_servos
from harness.simulation.step_state import allow_sleep
from harness.simulation.world_mjcf import add_object, parking_pose
from harness.simulation.wrench_sensors import add_wrench_sensors

FRICTION_DAMPING_PER_STEP = 1.5
"""Share of a sliding velocity that friction removes in one physics step.

MuJoCo's friction opposes the sliding velocity found at the start of a step, so a held object lags
its gripper on a curve: with centripetal acceleration a, step h and damping b it creeps with about
a (1 - h b) / b + a h / 2. That vanishes towards h b = 2, where velocities would oscillate for ever;
at 1.5 an oscillation halves each step. MuJoCo lets only explicit pairs have more than h b = 1.
"""


@dataclass(frozen=True, eq=False)
class ObjectPlace:
    """The indices of an object in the model.

    Attributes:
        qpos: The first of its seven position numbers, or the one of a part; -1 when static.
        dof: The first of its six velocity numbers, or the one of a part; -1 when static.
        parking: Its pose while absent, as xyz and quat wxyz, shape (7,).
    """

    obj: WorldObject
    body: int
    geoms: slice
    qpos: int
    dof: int
    parking: FloatArray


@dataclass(frozen=True, eq=False)
class PhysicsModel:
    """A MuJoCo model and the indices of its parts.

    Attributes:
        model: The compiled model; presence of objects and force limits are changed in place.
        servos: One servo for each actuated joint, in the order of the actuator ids.
        qpos: The position index of each movable joint, in description order.
        dof: The velocity index of each movable joint, in description order.
        actuated: The indices of the actuated joints in description order.
        objects: Simulated objects by name, in order.
        frames: The recorded links; the sensors hold 7 numbers for each, after the TCP's 7.
    """

    model: mujoco.MjModel
    description: RobotDescription
    servos: Servos
    qpos: IntArray
    dof: IntArray
    actuated: IntArray
    objects: Mapping[str, ObjectPlace]
    frames: tuple[str, ...]
    body_names: tuple[str, ...]
    robot_bodies: frozenset[int]


def build_model(
    description: RobotDescription,
    objects: Sequence[WorldObject],
    present: Collection[str],
    *,
    gravity: tuple[float, float, float],
    timestep: float,
    frames: Sequence[str] = (),
) -> PhysicsModel:
    """Compile the physics of a scenario.

    Args:
        objects: All objects that are ever in the world; planning-only objects are left out.
        frames: Links whose poses are recorded in addition to the TCP's.

    Raises:
        ModelRefused: MuJoCo cannot simulate one of the bodies.
    """
    simulated = [
        replace(obj, shapes=convex_shapes(obj.shapes)) for obj in objects if obj.in_simulation
    ]
    refuse_unusable_masses(simulated)
    servos, model = _compiled(description, simulated, present, gravity, timestep, frames)
    physics = _places(model, description, servos, simulated, tuple(frames))
    _set_surfaces(physics)
    for name, place in physics.objects.items():
        set_presence(model, place, present=name in present)
    return physics


def _compiled(
    description: RobotDescription,
    objects: Sequence[WorldObject],
    present: Collection[str],
    gravity: tuple[float, float, float],
    timestep: float,
    frames: Sequence[str],
) -> tuple[Servos, mujoco.MjModel]:
    """The servos and the compiled model, in which every surface has the same friction."""
    servos = design_servos(description, timestep)
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    option = spec.option
    option.timestep = timestep
    option.gravity = gravity
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.impratio = 10.0
    option.disableflags = mujoco.mjtDisableBit.mjDSBL_AUTORESET
    allow_sleep(option)
    add_robot(spec, description)
    add_servos(spec, description, servos)
    for index, obj in enumerate(objects):
        add_object(spec, obj, obj.pose if obj.name in present else parking_pose(index))
    if description.is_cell:
        make_independent(spec, sum(not obj.is_static for obj in objects))
    _add_grasp_contacts(spec, description, objects)
    _add_hole_contacts(spec, objects)
    for frame in (description.tcp_link, *frames):
        _add_frame_sensors(spec, frame)
    for joint in description.movable_joints:
        if joint.mimic is None:
            spec.add_sensor(
                type=mujoco.mjtSensor.mjSENS_ACTUATORFRC,
                objtype=mujoco.mjtObj.mjOBJ_ACTUATOR,
                objname=joint.name,
            )
    add_wrench_sensors(spec, description.wrench_sensors.values())
    return servos, compile_model(spec)


def _set_surfaces(physics: PhysicsModel) -> None:
    """Give every geom the friction of its surface."""
    model = physics.model
    for body in physics.robot_bodies:
        friction = link_friction(physics.description, physics.body_names[body])
        model.geom_friction[model.geom_bodyid == body] = roughness(friction)
    for place in physics.objects.values():
        frictions = [roughness(place.obj.friction_of(shape)) for shape in place.obj.shapes]
        model.geom_friction[place.geoms] = np.array(frictions).reshape(-1, 3)
    set_smaller_frictions(model)


def set_presence(model: mujoco.MjModel, place: ObjectPlace, *, present: bool) -> None:
    """Give an object contacts and weight, or neither."""
    model.geom_contype[place.geoms] = int(present)
    model.geom_conaffinity[place.geoms] = int(present)
    if not place.obj.is_static and place.obj.joint is None:
        model.body_gravcomp[place.body] = 0.0 if present else 1.0


def _add_frame_sensors(spec: mujoco.MjSpec, link: str) -> None:
    for kind in (mujoco.mjtSensor.mjSENS_FRAMEPOS, mujoco.mjtSensor.mjSENS_FRAMEQUAT):
        spec.add_sensor(type=kind, objtype=mujoco.mjtObj.mjOBJ_XBODY, objname=link)


def _add_grasp_contacts(
    spec: mujoco.MjSpec,
    description: RobotDescription,
    objects: Sequence[WorldObject],
) -> None:
    """Add an explicit contact pair for each geom of the fingers and of the free objects.

    Explicit pairs have their own friction damping, and are stiffer than other contacts.
    """
    damping = FRICTION_DAMPING_PER_STEP / spec.option.timestep
    for link in (link for gripper in description.grippers for link in gripper.links):
        for obj in (obj for obj in objects if not obj.is_static):
            for pair in _stiff_pairs(spec, link, obj.name):
                pair.solreffriction = -1.0, -damping


def _add_hole_contacts(spec: mujoco.MjSpec, objects: Sequence[WorldObject]) -> None:
    """Add an explicit contact pair for each geom of a body with a hole and of the free objects."""
    for block in (obj for obj in objects if obj.holes):
        for obj in (obj for obj in objects if not obj.is_static and obj.joint is None):
            _stiff_pairs(spec, block.name, obj.name)


def _stiff_pairs(spec: mujoco.MjSpec, first: str, second: str) -> list[mujoco.MjsPair]:
    """Explicit contact pairs of two bodies' geoms, stiffer than other contacts."""
    pairs = [
        spec.add_pair(geomname1=one.name, geomname2=other.name)
        for one in spec.body(first).geoms
        for other in spec.body(second).geoms
    ]
    for pair in pairs:
        pair.condim = CONTACT_DIMENSIONS
        pair.solref, pair.solimp = STIFF_SOLREF, STIFF_SOLIMP
    return pairs


def _places(
    model: mujoco.MjModel,
    description: RobotDescription,
    servos: Servos,
    simulated: Sequence[WorldObject],
    frames: tuple[str, ...],
) -> PhysicsModel:
    joints = [model.joint(name) for name in description.joint_names]
    objects: dict[str, ObjectPlace] = {}
    for index, obj in enumerate(simulated):
        body = model.body(obj.name)
        first = int(body.geomadr[0])
        joint = None if obj.is_static else model.joint(obj.name)
        objects[obj.name] = ObjectPlace(
            obj,
            int(body.id),
            slice(first, first + int(body.geomnum[0])) if first >= 0 else slice(0, 0),
            -1 if joint is None else int(joint.qposadr[0]),
            -1 if joint is None else int(joint.dofadr[0]),
            parking_pose(index).as_vector(),
        )
    names = tuple(model.body(index).name for index in range(model.nbody))
    links = set(description.link_names)
    actuated = [i for i, joint in enumerate(description.movable_joints) if joint.mimic is None]
    return PhysicsModel(
        model,
        description,
        servos,
        np.array([joint.qposadr[0] for joint in joints], dtype=np.int64),
        np.array([joint.dofadr[0] for joint in joints], dtype=np.int64),
        np.array(actuated, dtype=np.int64),
        objects,
        frames,
        names,
        frozenset(i for i, name in enumerate(names) if name in links and name != "world"),
    )
