"""Every element of an SDF world, and how it is imported.

The reader takes the notes on ignored elements from this table, and the documentation's table is
generated from it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from harness.language.files.xml_file import XmlElement
from harness.world.notes import Notes

Treatment = Literal["read", "ignored", "refused"]


@dataclass(frozen=True)
class Word:
    """An element or attribute.

    Attributes:
        treatment: Whether it is read, ignored or refused.
        meaning: Its effect, or the reason for which it has none.
        silent: Default values, which are left out without a note.
    """

    treatment: Treatment
    meaning: str
    silent: tuple[str, ...] = ()


def _read(meaning: str) -> Word:
    return Word("read", meaning)


def _ignored(meaning: str, *silent: str) -> Word:
    return Word("ignored", meaning, silent)


_UNDRAWN = Word("refused", "in a collision; not drawn in a visual")
_POSE = _read("with `relative_to`, `degrees`, `rotation_format`; `frame` as before SDF 1.7")
_NO_PLUGINS = _ignored("a world cannot execute code")
_DRAWN_PLAIN = _ignored("pictures have plain colours")
_FALSE = ("false", "0")
_TRUE = ("true", "1")
_ZERO = ("0", "0.0")

WORDS: Mapping[str, Mapping[str, Word]] = {
    "sdf": {
        "world": _read("the first; a file of models alone is a world of them"),
        "model": _read("as in a world"),
        "light": _read("as in a world"),
        "actor": _ignored("nothing moves by a script"),
    },
    "world": {
        "model": _read("an object; several when links are not joined"),
        "include": _read("of a model, from the model path"),
        "light": _read("directional ones"),
        "gravity": _read("m/s^2"),
        "physics": _read("the default one, else the first"),
        "frame": _read("for `relative_to`"),
        "joint": _read("of a model to the world or another model: they become one object"),
        "plugin": _NO_PLUGINS,
        "gui": _ignored("there is no window"),
        "scene": _ignored("pictures have a sky and shadows of their own"),
        "audio": _ignored("there is no sound"),
        "wind": _ignored("there is no air"),
        "atmosphere": _ignored("there is no air"),
        "magnetic_field": _ignored("there is no magnetism"),
        "spherical_coordinates": _ignored("there is no globe"),
        "state": _read("the poses of models in the first, as Gazebo classic has them on loading"),
        "population": _ignored("models that it would spawn are left out"),
        "actor": _ignored("nothing moves by a script"),
        "road": _ignored("there are no roads"),
    },
    "model": {
        "pose": _POSE,
        "static": _read("fixed in the world"),
        "link": _read("links that joints connect become one object"),
        "joint": _read(
            "fixed ones join links; others are held in their initial position, with a note"
        ),
        "frame": _read("for `relative_to`"),
        "model": _read("nested models, with `a::b` in `relative_to` and joints"),
        "include": _read("nested, or merged into the model with `merge`"),
        "plugin": _NO_PLUGINS,
        "self_collide": _ignored("an object is rigid", *_FALSE),
        "allow_auto_disable": _ignored("objects do not fall asleep", *_TRUE),
        "enable_wind": _ignored("there is no air", *_FALSE),
        "gripper": _ignored("the gripper is the robot's"),
    },
    "include": {
        "uri": _read("`model://`, `file://`, a path, a Fuel address that Gazebo has in its cache"),
        "name": _read("instead of the model's"),
        "pose": _read("instead of the model's"),
        "static": _read("instead of the model's"),
        "placement_frame": _read("the frame of the model that the pose is of"),
        "plugin": _NO_PLUGINS,
    },
    "link": {
        "pose": _POSE,
        "inertial": _read("without it 1 kg and 1 kg m^2, as SDF specifies, with a note"),
        "collision": _read("a collision shape"),
        "visual": _read("a visual shape"),
        "gravity": _ignored("gravity acts on every object that is not static", *_TRUE),
        "kinematic": _ignored("objects that are not static move by forces", *_FALSE),
        "self_collide": _ignored("an object is rigid", *_FALSE),
        "enable_wind": _ignored("there is no air", *_FALSE),
        "must_be_base_link": _ignored("an object is rigid", *_FALSE),
        "velocity_decay": _ignored("free objects have no damping"),
        "sensor": _read("a camera of any kind, on the object; other sensors lead to a note"),
        "light": _ignored("lights are the world's"),
        "projector": _ignored("there are no projectors"),
        "particle_emitter": _ignored("there are no particles"),
        "audio_source": _ignored("there is no sound"),
        "audio_sink": _ignored("there is no sound"),
        "battery": _ignored("there is no battery"),
    },
    "inertial": {
        "mass": _read("kg"),
        "pose": _read("of the centre of mass, and the axes of the tensor"),
        "inertia": _read("kg m^2; one that no rigid body can have is refused"),
        "density": _read("with `auto`, kg/m^3"),
        "fluid_added_mass": _ignored("there is no fluid"),
        "auto_inertia_params": _ignored("only solids of a formula have automatic inertia"),
        "frame": _ignored("see `pose`"),
    },
    "collision": {
        "pose": _POSE,
        "geometry": _read("see geometry"),
        "surface": _read("its friction"),
        "density": _read("with an `auto` inertial, kg/m^3"),
        "material_density": _ignored("see `density`"),
        "laser_retro": _ignored("there is no laser", *_ZERO),
        "max_contacts": _ignored("contacts are as many as there are"),
        "auto_inertia_params": _ignored("only solids of a formula have automatic inertia"),
    },
    "visual": {
        "pose": _POSE,
        "geometry": _read("see geometry"),
        "material": _read("its colour"),
        "transparency": _read("opacity of the colour"),
        "cast_shadows": _ignored("everything casts a shadow", *_TRUE),
        "laser_retro": _ignored("there is no laser", *_ZERO),
        "meta": _ignored("there are no layers"),
        "visibility_flags": _ignored("everything is visible"),
        "plugin": _NO_PLUGINS,
    },
    "geometry": {
        "box": _read("full size"),
        "cylinder": _read("radius and length"),
        "sphere": _read("radius"),
        "capsule": _read("radius, and length without the round ends"),
        "plane": _read("solid below its surface, unbounded"),
        "mesh": _read("its convex parts, with `scale`"),
        "empty": _read("no shape"),
        "ellipsoid": _read("radii; as 1,280 triangles, up to 0.5 % inside it"),
        "cone": _read("radius and length; as a pyramid of 32 sides"),
        "heightmap": _UNDRAWN,
        "image": _UNDRAWN,
        "polyline": _UNDRAWN,
    },
    "mesh": {
        "uri": _read("as in an include, or relative to the file"),
        "scale": _read("factor of the file's coordinates"),
        "submesh": _ignored("the whole mesh is used"),
        "convex_decomposition": _ignored("`collision` of the scenario chooses"),
    },
    "surface": {
        "friction": _read("see friction"),
        "bounce": _ignored("contacts do not bounce"),
        "contact": _ignored("all contacts are stiff, and everything collides"),
        "soft_contact": _ignored("all contacts are stiff"),
    },
    "friction": {
        "ode": _read("`mu`; see friction/ode"),
        "torsional": _read("coefficient times patch radius; see friction/torsional"),
        "bullet": _ignored("the friction of `ode` is used"),
    },
    "friction/ode": {
        "mu": _read("sliding friction; a contact takes the smaller of its two"),
        "mu2": _ignored("friction is the same in all directions"),
        "fdir1": _ignored("friction is the same in all directions", "0 0 0"),
        "slip1": _ignored("contacts do not slip by force", *_ZERO),
        "slip2": _ignored("contacts do not slip by force", *_ZERO),
    },
    "friction/torsional": {
        "coefficient": _read("times 3 pi/16 of the patch radius [m]"),
        "patch_radius": _read("m; with 0 the torsional friction is that of a small soft patch"),
        "use_patch_radius": _ignored("the patch radius is used", *_TRUE),
        "surface_radius": _ignored("the patch radius is used", *_ZERO),
        "ode": _ignored("contacts do not slip by force"),
    },
    "material": {
        "diffuse": _read("the colour"),
        "ambient": _read("the colour when there is no `diffuse`"),
        "script": _read("its name, for a plain colour of Gazebo"),
        "specular": _DRAWN_PLAIN,
        "emissive": _DRAWN_PLAIN,
        "shininess": _DRAWN_PLAIN,
        "shader": _DRAWN_PLAIN,
        "pbr": _DRAWN_PLAIN,
        "lighting": Word("ignored", _DRAWN_PLAIN.meaning, _TRUE),
        "double_sided": Word("ignored", _DRAWN_PLAIN.meaning, _FALSE),
        "render_order": Word("ignored", _DRAWN_PLAIN.meaning, _ZERO),
    },
    "joint": {
        "parent": _read("a link, a frame, `world`"),
        "child": _read("a link or a frame"),
        "pose": _read("for `relative_to`"),
        "axis": _ignored("the joint does not move"),
        "axis2": _ignored("the joint does not move"),
        "physics": _ignored("the joint does not move"),
        "sensor": _ignored("sensors are the robot's"),
        "gearbox_ratio": _ignored("the joint does not move"),
        "gearbox_reference_body": _ignored("the joint does not move"),
        "thread_pitch": _ignored("the joint does not move"),
        "screw_thread_pitch": _ignored("the joint does not move"),
    },
    "frame": {"pose": _POSE},
    "light": {
        "pose": _read("turns the direction"),
        "direction": _read("of a directional light"),
        "diffuse": _read("its colour"),
        "cast_shadows": _read("whether it casts shadows"),
        "light_on": _read("a light that is off is left out"),
        "intensity": _ignored("lights are equally bright", "1", "1.0"),
        "specular": _DRAWN_PLAIN,
        "attenuation": _ignored("a directional light is as bright everywhere"),
        "spot": _ignored("see lights"),
        "visualize": _ignored("lights are not drawn"),
    },
    "physics": {
        "max_step_size": _read(
            "the physics step, 0.1 ms to 20 ms; others are taken as 1 ms, with a note"
        ),
        "gravity": _read("as before SDF 1.5, m/s^2"),
        "real_time_factor": _ignored("there is no wall clock"),
        "real_time_update_rate": _ignored("there is no wall clock"),
        "max_contacts": _ignored("contacts are as many as there are"),
        "ode": _ignored("the physics is MuJoCo"),
        "bullet": _ignored("the physics is MuJoCo"),
        "simbody": _ignored("the physics is MuJoCo"),
        "dart": _ignored("the physics is MuJoCo"),
    },
    "sensor": {
        "pose": _POSE,
        "camera": _read("see camera"),
        "update_rate": _read("Hz, at most 120; 0 is the default"),
        "always_on": _ignored("pictures are taken by steps and videos", *_TRUE),
        "visualize": _ignored("there is no window", *_FALSE),
        "topic": _ignored("there are no topics while it runs"),
        "enable_metrics": _ignored("there is no wall clock", *_FALSE),
        "plugin": _NO_PLUGINS,
    },
    "camera": {
        "pose": _read("on the sensor's"),
        "horizontal_fov": _read("rad, up to 2.9"),
        "image": _read("see image"),
        "clip": _read("see clip"),
        "noise": _read("see noise"),
        "optical_frame_id": _read("of message headers"),
        "camera_info_topic": _ignored("there are no topics while it runs"),
        "trigger_topic": _ignored("there are no topics while it runs"),
        "triggered": _ignored("pictures are taken by steps", *_FALSE),
        "save": _ignored("`capture` keeps pictures"),
        "depth_camera": _ignored("`capture` says which kinds of picture"),
        "segmentation_type": _ignored("`capture` says which kinds of picture"),
        "box_type": _ignored("no boxes are drawn"),
        "distortion": _ignored("pictures are those of a pinhole"),
        "lens": _ignored("pictures are those of a pinhole"),
        "visibility_mask": _ignored("everything is visible"),
    },
    "image": {
        "width": _read("8 to 2048 pixels"),
        "height": _read("8 to 2048 pixels"),
        "format": _read("`R8G8B8` or `L8`; others as `R8G8B8`, with a note"),
        "anti_aliasing": _ignored("the renderer selects its antialiasing"),
    },
    "clip": {
        "near": _read("m"),
        "far": _read("m"),
    },
    "noise": {
        "type": _read("`gaussian` or `none`"),
        "mean": _read("as a share of full white"),
        "stddev": _read("as a share of full white"),
        "bias_mean": _ignored("a camera's noise has none"),
        "bias_stddev": _ignored("a camera's noise has none"),
        "precision": _ignored("pictures have 256 steps"),
    },
}
"""Children of each kind of element."""


def note_unread_elements(element: XmlElement, kind: str, notes: Notes) -> None:
    """Note every child of an element that is not read.

    Args:
        element: The element of the file.
        kind: Its kind in `WORDS`.
        notes: The list that collects the notes.
    """
    words = WORDS[kind]
    for child in element.children:
        word = words.get(child.tag)
        if word is None:
            notes.add(child.place, f"<{child.tag}> of <{element.tag}> is not known and left out")
        elif word.treatment == "ignored" and child.text.strip() not in word.silent:
            notes.add(child.place, f"<{child.tag}> of <{element.tag}> is left out: {word.meaning}")
