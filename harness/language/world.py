"""Objects and worlds as files say them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from harness.language.base import (
    Color,
    Duration,
    Flag,
    Length,
    Mass,
    Name,
    Number,
    PositiveLength,
    SpecModel,
    Xyz,
    kind_of,
)
from harness.language.cameras import CameraSpec
from harness.language.markers import MarkerSpec
from harness.language.poses import Pose

COLOR = "Red, green, blue, opacity from 0 to 1; or a name as in CSS: `red`."


class BoxSpec(SpecModel):
    """Full size along x, y, z [m]."""

    size: tuple[PositiveLength, PositiveLength, PositiveLength] = Field(
        description="Full size along x, y, z [m]."
    )


class CylinderSpec(SpecModel):
    """About its z axis [m]."""

    radius: PositiveLength = Field(description="[m]")
    length: PositiveLength = Field(description="[m]")


class SphereSpec(SpecModel):
    """A radius [m]."""

    radius: PositiveLength = Field(description="[m]")


class CapsuleSpec(SpecModel):
    """About its z axis; `length` is the cylindrical part [m]."""

    radius: PositiveLength = Field(description="[m]")
    length: PositiveLength = Field(description="Without the round ends [m].")


class PlaneSpec(SpecModel):
    """Solid below z = 0 of its pose."""


class MeshSpec(SpecModel):
    """A triangle mesh file beside the world or scenario file."""

    file: str = Field(description="Path from the file that names it.")
    scale: Annotated[
        Annotated[Number, Tag("one")] | Annotated[tuple[Number, Number, Number], Tag("many")],
        Discriminator(kind_of),
    ] = Field(
        default=1.0,
        description="Of the file's numbers to metres; one number, or one for each axis.",
    )


class FrictionSpec(SpecModel):
    """Coulomb friction of the surface; a contact takes the smaller of its two."""

    sliding: Annotated[Number, Field(ge=0)] = Field(default=1.0, description="Along the surface.")
    torsional: Annotated[Number, Field(ge=0)] = Field(
        default=0.005, description="About the contact's normal [m]."
    )
    rolling: Annotated[Number, Field(ge=0)] = Field(
        default=0.0001, description="Against rolling [m]."
    )


GEOMETRIES = ("box", "cylinder", "sphere", "capsule", "plane", "mesh", "marker")

SurfaceFriction = Annotated[
    Annotated[Number, Field(ge=0), Tag("one")] | Annotated[FrictionSpec, Tag("many")],
    Discriminator(kind_of),
]


class ShapeSpec(SpecModel):
    """Exactly one geometry, placed on its object."""

    name: Name | None = Field(default=None, description="For people.")
    pose: Pose = Field(default=Pose(), description="On the object; its frame word is ignored.")
    color: Color | None = Field(default=None, description=COLOR)
    friction: SurfaceFriction | None = Field(
        default=None, description="Where it differs from its object's."
    )
    box: BoxSpec | None = None
    cylinder: CylinderSpec | None = None
    sphere: SphereSpec | None = None
    capsule: CapsuleSpec | None = None
    plane: PlaneSpec | None = None
    mesh: MeshSpec | None = None
    marker: MarkerSpec | None = None

    @model_validator(mode="after")
    def _one_geometry(self) -> ShapeSpec:
        given = [kind for kind in GEOMETRIES if getattr(self, kind) is not None]
        if len(given) != 1:
            found = " and ".join(given) or "none"
            raise ValueError(f"a shape is exactly one of {', '.join(GEOMETRIES)}; found {found}")
        return self


class InertiaSpec(SpecModel):
    """About the centre of mass, body axes [kg m^2]."""

    ixx: Number
    iyy: Number
    izz: Number
    ixy: Number = 0.0
    ixz: Number = 0.0
    iyz: Number = 0.0


class ObjectSpec(SpecModel):
    """An object: one geometry beside its keys, or several under `shapes`.

    One with `visuals` alone is seen and touches nothing.
    """

    name: Name = Field(description="Unique in the scene.")
    pose: Pose = Field(
        default=Pose(),
        description="Where it stands at the start; its origin is its centre. `frame` may be an "
        "object that stands in the list before it.",
    )
    static: Flag = Field(default=False, description="Fixed in the world.")
    box: BoxSpec | None = None
    cylinder: CylinderSpec | None = None
    sphere: SphereSpec | None = None
    capsule: CapsuleSpec | None = None
    plane: PlaneSpec | None = None
    mesh: MeshSpec | None = None
    marker: MarkerSpec | None = None
    shapes: tuple[ShapeSpec, ...] = Field(
        default=(), description="Several geometries of one object."
    )
    visuals: tuple[ShapeSpec, ...] = Field(
        default=(), description="What pictures show in place of the shapes."
    )
    mass: Mass | None = Field(
        default=None,
        description="[kg]; default from the volume at 1000 kg/m^3, of a mesh that of its hull.",
    )
    center_of_mass: Xyz = Field(
        default=(0.0, 0.0, 0.0), description="From the object's origin [m]."
    )
    inertia: InertiaSpec | None = Field(default=None, description="Default: of the solid shapes.")
    friction: SurfaceFriction | None = Field(
        default=None, description="Sliding friction alone, or all three."
    )
    color: Color | None = Field(default=None, description=COLOR)
    in_: Literal["planning", "simulation", "both"] = Field(
        default="both",
        alias="in",
        description="Who knows it: the planning scene, the physics, or both.",
    )
    replace: Flag = Field(
        default=False, description="In `objects`: replaces the world's object so named."
    )

    @model_validator(mode="after")
    def _some_shape(self) -> ObjectSpec:
        given = [kind for kind in GEOMETRIES if getattr(self, kind) is not None]
        is_only_seen = bool(self.visuals) and not given
        if len(given) > 1 or (bool(given) == bool(self.shapes) and not is_only_seen):
            raise ValueError(
                f"an object is exactly one of {', '.join(GEOMETRIES)}, or several `shapes`"
            )
        return self


class LightSpec(SpecModel):
    """A directional light."""

    direction: tuple[Number, Number, Number] = Field(
        default=(-0.5, 0.1, -0.9), description="Where it shines to."
    )
    diffuse: Color = Field(default=(0.8, 0.8, 0.8, 1.0), description=COLOR)
    casts_shadow: Flag = Field(default=True, description="In pictures.")


class PhysicsSpec(SpecModel):
    """Of the simulation."""

    timestep: Annotated[Duration, Field(ge=1e-4, le=0.02)] = Field(default=0.001, description="[s]")
    gravity: tuple[Length, Length, Length] = Field(default=(0.0, 0.0, -9.8), description="[m/s**2]")


class WorldSpec(SpecModel):
    """What stands around the robot, and the physics it stands in."""

    world: Name = Field(description="Its title.")
    description: str = Field(default="", description="For people.")
    objects: tuple[ObjectSpec, ...] = Field(default=(), description="What stands in it.")
    lights: tuple[LightSpec, ...] = Field(default=(), description="For pictures.")
    cameras: tuple[CameraSpec, ...] = Field(
        default=(), description="In the world, on objects, or on links of whatever robot."
    )
    physics: PhysicsSpec = Field(default=PhysicsSpec(), description="Time step and gravity.")
