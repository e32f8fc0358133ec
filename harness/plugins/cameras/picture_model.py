"""A MuJoCo model for pictures, with one mocap body for each link and object."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from harness.cameras.meshes import MeshPart, mesh_parts
from harness.core.geometry import Box, Capsule, Cylinder, Geometry, Mesh, Plane, Rgba, Shape, Sphere
from harness.core.spatial import SE3
from harness.core.world import WorldObject
from harness.robot.description import RobotDescription

SOLID_GROUP = 0  # group of MuJoCo's geoms that a renderer shows or hides
TRANSLUCENT_GROUP = 1
FLOOR_GROUP = 2
FLOOR, EYE = "floor", "eye"

GHOST_ALPHA = 0.3  # opacity of objects that only the planning scene has
LEAST_CORNERS = 4  # of a mesh in MuJoCo
LEAST_AREA = 1e-9  # [m^2], of a part of a mesh: MuJoCo refuses a smaller one

SKY_TOP, HORIZON = (0.80, 0.85, 0.91), (0.95, 0.96, 0.97)
FLOOR_COLOUR, FLOOR_LINES = (0.90, 0.905, 0.91), (0.82, 0.83, 0.84)
LIGHT_DIRECTION = (0.30, 0.45, -0.84)


@dataclass(frozen=True, eq=False)
class PictureModel:
    """A compiled model for renderers.

    Attributes:
        model: The model; `mocap_pos` and `mocap_quat` pose its bodies.
        data: The poses of the bodies; geoms of hidden bodies have no opacity.
        mocap: Mocap index of each link and object that has visuals.
        geoms: Geom ids of each link and object.
        rgba: Colours of the visible geoms, shape (G, 4).
        eye: Id of the camera that renderers move to their viewpoint.
    """

    model: mujoco.MjModel
    data: mujoco.MjData
    mocap: Mapping[str, int]
    geoms: Mapping[str, slice]
    rgba: np.ndarray
    eye: int = 0

    def pose(self, poses: Mapping[str, SE3]) -> None:
        """Pose the named bodies and hide all others."""
        for name, index in self.mocap.items():
            geoms = self.geoms[name]
            pose = poses.get(name)
            self.model.geom_rgba[geoms] = self.rgba[geoms] if pose is not None else 0.0
            if pose is not None:
                self.data.mocap_pos[index] = pose.translation
                self.data.mocap_quat[index] = pose.quat_wxyz
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_camlight(self.model, self.data)


def build_picture_model(
    description: RobotDescription,
    objects: Sequence[WorldObject],
    *,
    floor_height: float,
    width: int,
    height: int,
) -> PictureModel:
    """Compile the visuals of a robot and its world.

    Args:
        objects: All objects; a plane among them becomes the floor.
        floor_height: The z coordinate of the floor [m].
        width: Largest width of a picture [pixels].
        height: Largest height of a picture [pixels].
    """
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.visual.global_.offwidth, spec.visual.global_.offheight = width, height
    _add_surroundings(spec, floor_height)
    spec.worldbody.add_camera(name=EYE)
    for link in description.links:
        _add_body(spec, link.name, link.visuals, ghost=False)
    for obj in objects:
        _add_body(spec, obj.name, obj.visuals or obj.shapes, ghost=not obj.in_simulation)
    model = spec.compile()
    mocap: dict[str, int] = {}
    geoms: dict[str, slice] = {}
    for body in (model.body(index) for index in range(1, model.nbody)):
        first, count = int(body.geomadr[0]), int(body.geomnum[0])
        mocap[body.name] = int(body.mocapid[0])
        geoms[body.name] = slice(first, first + count)
    return PictureModel(model, mujoco.MjData(model), mocap, geoms, model.geom_rgba.copy())


def _add_body(spec: mujoco.MjSpec, name: str, shapes: Sequence[Shape], *, ghost: bool) -> None:
    drawn = [shape for shape in shapes if not isinstance(shape.geometry, Plane)]
    if not drawn:
        return
    body = spec.worldbody.add_body(name=name, mocap=True)
    for shape in drawn:
        for geometry, colour in _pieces(spec, shape):
            red, green, blue, alpha = colour or shape.rgba
            alpha = min(alpha, GHOST_ALPHA) if ghost else alpha
            geom = _add_geom(body, geometry)
            geom.pos, geom.quat = shape.pose.translation, shape.pose.quat_wxyz
            geom.rgba = red, green, blue, alpha
            geom.group = SOLID_GROUP if alpha >= 1.0 else TRANSLUCENT_GROUP
            geom.castshadow = not ghost
            geom.contype = geom.conaffinity = 0


def _pieces(spec: mujoco.MjSpec, shape: Shape) -> list[tuple[Geometry | str, Rgba | None]]:
    """A shape as MuJoCo's primitive, or as names of mesh assets with their colours."""
    geometry = shape.geometry
    if not isinstance(geometry, Mesh):
        return [(geometry, None)]
    key = f"{geometry.path}|{geometry.scale}"
    pieces: list[tuple[Geometry | str, Rgba | None]] = []
    for number, part in enumerate(mesh_parts(geometry)):
        if _area(part) < LEAST_AREA:
            continue
        name = f"{key}|{number}"
        if spec.mesh(name) is None:
            asset = spec.add_mesh(name=name)
            lack = max(0, LEAST_CORNERS - len(part.vertices))
            asset.uservert = np.pad(part.vertices, ((0, lack), (0, 0)), mode="edge").ravel()
            asset.userface = part.faces.ravel()
            asset.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
        pieces.append((name, part.rgba))
    return pieces


def _area(part: MeshPart) -> float:
    """Area of the triangles of a part [m^2]."""
    a, b, c = np.moveaxis(part.vertices[part.faces], 1, 0)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def _add_geom(body: mujoco.MjsBody, geometry: Geometry | str) -> mujoco.MjsGeom:
    kinds = mujoco.mjtGeom
    match geometry:
        case str():
            return body.add_geom(type=kinds.mjGEOM_MESH, meshname=geometry)
        case Box(size=size):
            return body.add_geom(type=kinds.mjGEOM_BOX, size=[0.5 * side for side in size])
        case Cylinder(radius=radius, length=length):
            return body.add_geom(type=kinds.mjGEOM_CYLINDER, size=[radius, length / 2, 0])
        case Sphere(radius=radius):
            return body.add_geom(type=kinds.mjGEOM_SPHERE, size=[radius, 0, 0])
        case Capsule(radius=radius, length=length):
            return body.add_geom(type=kinds.mjGEOM_CAPSULE, size=[radius, length / 2, 0])
        case _:
            raise AssertionError(geometry)


def _add_surroundings(spec: mujoco.MjSpec, floor_height: float) -> None:
    """Sky, floor and light."""
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=SKY_TOP,
        rgb2=HORIZON,
        width=256,
        height=256,
    )
    spec.add_texture(
        name=FLOOR,
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        mark=mujoco.mjtMark.mjMARK_EDGE,
        rgb1=FLOOR_COLOUR,
        rgb2=FLOOR_COLOUR,
        markrgb=FLOOR_LINES,
        width=256,
        height=256,
    )
    material = spec.add_material(name=FLOOR, texuniform=True, texrepeat=[2.0, 2.0], specular=0.0)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = FLOOR
    floor = spec.worldbody.add_geom(
        name=FLOOR, type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 0.05], material=FLOOR
    )
    floor.pos = 0.0, 0.0, floor_height
    floor.group = FLOOR_GROUP
    floor.castshadow = False  # it would speckle itself with its own shadow
    floor.contype = floor.conaffinity = 0
    light = spec.worldbody.add_light(
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, dir=LIGHT_DIRECTION, castshadow=True
    )
    light.pos = -4.0 * np.array(LIGHT_DIRECTION)
    light.diffuse, light.specular = [0.48] * 3, [0.15] * 3
    head = spec.visual.headlight
    head.ambient, head.diffuse, head.specular = [0.44] * 3, [0.26] * 3, [0.05] * 3
    spec.visual.quality.shadowsize = 4096
    spec.visual.quality.offsamples = 4
    spec.visual.map.haze = 0.4
    spec.visual.rgba.haze = (*HORIZON, 1.0)
