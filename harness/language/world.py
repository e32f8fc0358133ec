"""Objects and worlds as files describe them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, cast

from pydantic import Discriminator, Field, Tag, model_validator

from harness.core.geometry import CollisionMode, Geometry, Shape
from harness.core.surface_motion import SurfaceMotion
from harness.language.base import (
    AngularVelocity,
    Color,
    Duration,
    Flag,
    Length,
    LinearVelocity,
    Mass,
    Name,
    Number,
    PositiveLength,
    SpecModel,
    Xyz,
    kind_of,
)
from harness.language.cameras import CameraSpec
from harness.language.plugin_field import KeyModel, PluginModel
from harness.language.poses import Pose

if TYPE_CHECKING:
    from pathlib import Path

    from harness.core.spatial import SE3
    from harness.core.world import Hole, WorldObject

COLOR = "Red, green, blue, opacity from 0 to 1; or a name as in CSS: `red`."


class ShapeKey(KeyModel):
    """A key of a shape that stands for other shapes."""

    def solid(self) -> Geometry:
        """What planner and physics know of it."""
        raise NotImplementedError

    def printed(self, pose: SE3, name: str) -> tuple[Shape, ...]:
        """What pictures show of it at a pose."""
        raise NotImplementedError


class HoleKey(KeyModel):
    """The key of a box that has a hole."""

    @property
    def is_round(self) -> bool:
        """Whether the mass of the box with the hole is unknown."""
        raise NotImplementedError

    def refuse_outside(self, box: tuple[float, float, float]) -> None:
        """Check that a box has walls around the hole."""
        raise NotImplementedError

    def bored(self, whole: Shape) -> tuple[tuple[Shape, ...], Hole]:
        """The shapes of a box with the hole, and the hole."""
        raise NotImplementedError


class BoxSpec(SpecModel):
    """A box by its full size along x, y, z [m]."""

    size: tuple[PositiveLength, PositiveLength, PositiveLength] = Field(
        description="The full size along x, y, z [m]."
    )
    hole: Annotated[HoleKey, PluginModel("hole")] | None = Field(
        default=None, description="A hole from the upper face, along z, for a peg."
    )

    @model_validator(mode="after")
    def _walls(self) -> BoxSpec:
        if self.hole is not None:
            self.hole.refuse_outside(self.size)
        return self


class CylinderSpec(SpecModel):
    """A cylinder about its z axis [m]."""

    radius: PositiveLength = Field(description="The radius of the cylinder [m].")
    length: PositiveLength = Field(description="The length of the cylinder along z [m].")


class SphereSpec(SpecModel):
    """A sphere by its radius [m]."""

    radius: PositiveLength = Field(description="The radius of the sphere [m].")


class CapsuleSpec(SpecModel):
    """A capsule about its z axis; `length` is that of the cylindrical part [m]."""

    radius: PositiveLength = Field(description="The radius of the capsule [m].")
    length: PositiveLength = Field(description="The length without the round ends [m].")


class PlaneSpec(SpecModel):
    """A plane that is solid below z = 0 of its pose."""


class MeshSpec(SpecModel):
    """A triangle mesh file next to the world or scenario file."""

    file: str = Field(description="The path of the mesh, from the file that names it.")
    scale: Annotated[
        Annotated[Number, Tag("one")] | Annotated[tuple[Number, Number, Number], Tag("many")],
        Discriminator(kind_of),
    ] = Field(
        default=1.0,
        description="The factor from the file's numbers to metres; one number, or one for each "
        "axis.",
    )
    collision: CollisionMode | None = Field(
        default=None,
        description="How the mesh collides: as its convex `hull`, as convex `parts`, or `exact`: "
        "the planner then checks its triangles, and the physics collides with the parts. "
        "By default as the scenario's `collision` says.",
    )


class FrictionSpec(SpecModel):
    """Coulomb friction of the surface; a contact takes the smaller of its two."""

    sliding: Annotated[Number, Field(ge=0)] = Field(
        default=1.0, description="The friction coefficient along the surface."
    )
    torsional: Annotated[Number, Field(ge=0)] = Field(
        default=0.005, description="The friction coefficient about the contact's normal [m]."
    )
    rolling: Annotated[Number, Field(ge=0)] = Field(
        default=0.0001, description="The friction coefficient against rolling [m]."
    )


GEOMETRIES = ("box", "cylinder", "sphere", "capsule", "plane", "mesh", "marker")

SurfaceFriction = Annotated[
    Annotated[Number, Field(ge=0), Tag("one")] | Annotated[FrictionSpec, Tag("many")],
    Discriminator(kind_of),
]


SurfaceVelocity = Annotated[
    Annotated[LinearVelocity, Tag("one")]
    | Annotated[tuple[LinearVelocity, LinearVelocity, LinearVelocity], Tag("many")],
    Discriminator(kind_of),
]
"""The velocity of a surface along the x axis of its object, or in the object's axes."""


def surface_motion(velocity: SurfaceVelocity | None, rotation: float | None) -> SurfaceMotion:
    """The motion of a surface as a file says it."""
    if isinstance(velocity, tuple):
        return SurfaceMotion(velocity, rotation or 0.0)
    return SurfaceMotion((velocity or 0.0, 0.0, 0.0), rotation or 0.0)


class ShapeSpec(SpecModel):
    """A shape: exactly one geometry, placed on its object."""

    one_of = GEOMETRIES

    name: Name | None = Field(default=None, description="A name of the shape for people.")
    pose: Pose = Field(
        default=Pose(), description="The pose of the shape on the object; its frame is ignored."
    )
    color: Color | None = Field(default=None, description=COLOR)
    friction: SurfaceFriction | None = Field(
        default=None, description="The friction of the shape, where it differs from its object's."
    )
    box: BoxSpec | None = None
    cylinder: CylinderSpec | None = None
    sphere: SphereSpec | None = None
    capsule: CapsuleSpec | None = None
    plane: PlaneSpec | None = None
    mesh: MeshSpec | None = None
    marker: Annotated[ShapeKey, PluginModel("marker")] | None = None


class InertiaSpec(SpecModel):
    """The inertia about the centre of mass, along the body's axes [kg m^2]."""

    ixx: Number
    iyy: Number
    izz: Number
    ixy: Number = 0.0
    ixz: Number = 0.0
    iyz: Number = 0.0


class PartKey(KeyModel):
    """A part of a static object that turns or slides: an object of its own, `cabinet/door`."""

    name: Name = Field(description="The name of the joint; the part is called `OBJECT/NAME`.")

    def part(
        self, spec: ObjectSpec, fixture: WorldObject, base_dir: Path, collision: CollisionMode
    ) -> WorldObject:
        """The part of a fixture, with every number known."""
        raise NotImplementedError


class ObjectSpec(SpecModel):
    """An object: one geometry next to its keys, or several under `shapes`.

    One with `visuals` alone is seen and touches nothing; one with `joints` alone carries its parts.
    """

    name: Name = Field(
        description="The name of the object, unique in the scene; not `robot`, `gripper`, `any`,"
        " `tcp` or `world`."
    )
    pose: Pose = Field(
        default=Pose(),
        description="The pose of the object at the start; its origin is its centre. `frame` "
        "may be an object that stands in the list before it.",
    )
    static: Flag = Field(default=False, description="Whether the object is fixed in the world.")
    box: BoxSpec | None = None
    cylinder: CylinderSpec | None = None
    sphere: SphereSpec | None = None
    capsule: CapsuleSpec | None = None
    plane: PlaneSpec | None = None
    mesh: MeshSpec | None = None
    marker: Annotated[ShapeKey, PluginModel("marker")] | None = None
    shapes: tuple[ShapeSpec, ...] = Field(
        default=(), description="The geometries of an object that has several."
    )
    visuals: tuple[ShapeSpec, ...] = Field(
        default=(), description="The geometries that pictures show in place of the shapes."
    )
    mass: Mass | None = Field(
        default=None,
        description="The mass [kg]; the default follows from the volume at 1000 kg/m^3, of a mesh "
        "from that of its hull.",
    )
    center_of_mass: Xyz = Field(
        default=(0.0, 0.0, 0.0), description="The centre of mass, from the object's origin [m]."
    )
    inertia: InertiaSpec | None = Field(
        default=None, description="The inertia; the default is that of the solid shapes."
    )
    friction: SurfaceFriction | None = Field(
        default=None, description="The friction: the sliding coefficient alone, or all three."
    )
    color: Color | None = Field(default=None, description=COLOR)
    joints: tuple[Annotated[PartKey, PluginModel("joint")], ...] = Field(
        default=(),
        description="The parts of a `static` object that turn or slide: doors, drawers, lids.",
    )
    in_: Literal["planning", "simulation", "both"] = Field(
        default="both",
        alias="in",
        description="The scenes that know the object: the planning scene, the physics, or both.",
    )
    surface_velocity: SurfaceVelocity | None = Field(
        default=None,
        description="The velocity of the surface of a `static` object at the start, as a belt's"
        " [m/s]: a number along the object's x axis, or a vector in the object's axes. 0 for a"
        " belt that the step `conveyor` starts.",
    )
    surface_rotation: AngularVelocity | None = Field(
        default=None,
        description="The rate at which the surface of a `static` object turns about the object's z"
        " axis at the start, as a turntable's [rad/s].",
    )
    replace: Flag = Field(
        default=False,
        description="Whether this replaces the world's object of this name; used in `objects`.",
    )

    @property
    def surface_motion(self) -> SurfaceMotion | None:
        """How the surface of a belt or a turntable moves at the start; None for other objects."""
        if self.surface_velocity is None and self.surface_rotation is None:
            return None
        return surface_motion(self.surface_velocity, self.surface_rotation)

    @classmethod
    def unknown_key_hint(cls, key: str, content: Mapping[str, Any]) -> str:
        """The key of the shape that a message of MoveIt has in `type` and `dimensions`."""
        if key in ("suction", "vacuum", "magnet"):
            return (
                "suction cups are a gripper: `robot: {model: ur5e, gripper: suction_cup}`; any"
                " smooth face of an object has room for them"
            )
        if key in ("conveyor", "belt", "turntable"):
            return (
                "a belt is an object with `static: true` and `surface_velocity: 0.1`, a turntable"
                " one with `surface_rotation`; the step `conveyor` starts and stops either"
            )
        if key in ("hinge", "slide", "door", "drawer"):
            return (
                "doors and drawers are `joints` of an object:"
                " [{name: door, hinge: {axis: [0, 0, 1], ...}, ...}]"
            )
        return _shape_words(content) if key in ("type", "dimensions") else ""

    @model_validator(mode="after")
    def _some_shape(self) -> ObjectSpec:
        given = [kind for kind in GEOMETRIES if getattr(self, kind) is not None]
        needs_none = bool(self.visuals or self.joints) and not given
        if len(given) > 1 or (bool(given) == bool(self.shapes) and not needs_none):
            raise ValueError(
                f"an object is exactly one of {', '.join(GEOMETRIES)}, or several `shapes`"
            )
        if not self.static and self.surface_motion is not None:
            raise ValueError(
                "only the surface of a static object moves: add `static: true`, or leave out"
                " `surface_velocity` and `surface_rotation`"
            )
        boxes = [self.box, *(shape.box for shape in self.shapes)]
        holes = [box.hole for box in boxes if box is not None and box.hole is not None]
        if not self.static and any(hole.is_round for hole in holes):
            raise ValueError(
                "the mass of a box with a round hole is not known: say `static: true`, or give the"
                " hole a `size`"
            )
        if self.joints and not self.static:
            raise ValueError("an object with `joints` is fixed in the world: say `static: true`")
        names = [joint.name for joint in self.joints]
        if twice := [name for name in names if names.count(name) > 1]:
            raise ValueError(f"two joints are called '{twice[0]}'")
        return self


def _shape_words(content: Mapping[str, Any]) -> str:
    """The shape of `type: box` and `dimensions: [...]` as this language has it."""
    kind, sizes = str(content.get("type", "")).lower(), content.get("dimensions")
    numbers = cast("list[Any]", sizes) if isinstance(sizes, list) else []
    names = {"box": "size", "sphere": "radius", "cylinder": "length, radius"}.get(kind, "")
    if not names:
        return "the shape is a key: `box: {size: [X, Y, Z]}`, `cylinder: {radius: R, length: L}`"
    if kind == "box":
        inner = f"size: [{', '.join(map(str, numbers or 'XYZ'))}]"
    else:
        each = names.split(", ")
        values = numbers if len(numbers) == len(each) else [name[0].upper() for name in each]
        inner = ", ".join(f"{name}: {value}" for name, value in zip(each, values, strict=True))
    return f"write `{kind}: {{{inner}}}`"


class LightSpec(SpecModel):
    """A directional light of the world."""

    direction: tuple[Number, Number, Number] = Field(
        default=(-0.5, 0.1, -0.9), description="The direction in which the light shines."
    )
    diffuse: Color = Field(default=(0.8, 0.8, 0.8, 1.0), description=COLOR)
    casts_shadow: Flag = Field(
        default=True, description="Whether the light casts shadows in pictures."
    )


class PhysicsSpec(SpecModel):
    """The settings of the physics simulation."""

    timestep: Annotated[Duration, Field(ge=1e-4, le=0.02)] = Field(
        default=0.001, description="The time step of the physics [s]."
    )
    gravity: tuple[Length, Length, Length] = Field(
        default=(0.0, 0.0, -9.8), description="The gravity vector in the world [m/s**2]."
    )


class WorldSpec(SpecModel):
    """A world: what stands around the robot, and its physics."""

    world: Name = Field(description="The title of the world.")
    description: str = Field(default="", description="A description of the world for people.")
    objects: tuple[ObjectSpec, ...] = Field(
        default=(), description="The objects that stand in the world."
    )
    lights: tuple[LightSpec, ...] = Field(default=(), description="The lights, for pictures.")
    cameras: tuple[CameraSpec, ...] = Field(
        default=(), description="The cameras in the world, on objects, or on links of the robot."
    )
    physics: PhysicsSpec = Field(
        default=PhysicsSpec(), description="The time step and gravity of the physics."
    )
