"""The elements of an SDF world that are read; a note names every other one."""

from __future__ import annotations

from harness.language.files.xml_file import XmlElement
from harness.plugins.formats.notes import Notes

READ = {
    kind: tuple(words.split())
    for kind, words in {
        "sdf": "world model light",
        "world": "model include light gravity physics frame joint state",
        "model": "pose static link joint frame model include",
        "robot": "pose static link joint frame model include gripper",
        "include": "uri name pose static placement_frame",
        "link": "pose inertial collision visual sensor",
        "inertial": "mass pose inertia density",
        "collision": "pose geometry surface density",
        "visual": "pose geometry material transparency",
        "geometry": "box cylinder sphere capsule plane mesh empty ellipsoid cone",
        "mesh": "uri scale",
        "surface": "friction",
        "friction": "ode torsional",
        "friction/ode": "mu",
        "friction/torsional": "coefficient patch_radius",
        "material": "diffuse ambient script",
        "joint": "parent child pose axis",
        "axis": "xyz limit dynamics use_parent_model_frame",
        "limit": "lower upper",
        "robot/axis": "xyz limit dynamics use_parent_model_frame mimic",
        "robot/limit": "lower upper effort velocity",
        "robot/dynamics": "friction damping",
        "dynamics": "friction damping spring_stiffness spring_reference",
        "frame": "pose",
        "light": "pose direction diffuse cast_shadows light_on",
        "physics": "max_step_size gravity",
        "sensor": "pose camera update_rate",
        "camera": "pose horizontal_fov image clip noise optical_frame_id",
        "image": "width height format",
        "clip": "near far",
        "noise": "type mean stddev",
    }.items()
}
"""The children of each kind of element that have an effect."""

OFF = ("false", "0", "0.0", "0 0 0")
ON = ("true", "1", "1.0")
ON_BY_DEFAULT = (
    "allow_auto_disable",
    "always_on",
    "cast_shadows",
    "gravity",
    "intensity",
    "lighting",
    "use_patch_radius",
)
"""Elements that are on unless a file turns them off; here they always are."""


def note_unread_elements(element: XmlElement, kind: str, notes: Notes) -> None:
    """Note every child of an element that is not read, unless it states what holds anyway.

    Args:
        kind: Its kind in `READ`.
    """
    for child in element.children:
        without_effect = ON if child.tag in ON_BY_DEFAULT else OFF
        if child.tag not in READ[kind] and child.text.strip() not in without_effect:
            notes.add(child.place, f"<{child.tag}> of <{element.tag}> is left out")
