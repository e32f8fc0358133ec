"""Imports SDF's camera sensors."""

from __future__ import annotations

import math
from typing import Any

from harness.language.cameras import CameraSpec
from harness.language.files.xml_file import XmlElement
from harness.plugins.formats.notes import Notes
from harness.plugins.formats.plain_values import pose_spec
from harness.plugins.formats.sdf.bodies import SdfBody, SdfLink
from harness.plugins.formats.sdf.elements import note_unread_elements
from harness.plugins.formats.sdf.values import number, numbers_of, pose_of, text_of, validated

KINDS = ("camera", "rgbd_camera", "depth", "depth_camera", "segmentation", "segmentation_camera")
"""Types of sensors that are imported as cameras; `capture` selects the kinds of picture."""

FORMATS = {"R8G8B8": "R8G8B8", "RGB_INT8": "R8G8B8", "L8": "L8", "L_INT8": "L8"}
WIDEST, NARROWEST = 2.9, 0.01  # [rad]
PIXELS = (8, 2048)
FASTEST = 120.0  # [Hz]


def cameras_of(body: SdfBody, notes: Notes, *, is_there: bool) -> list[CameraSpec]:
    """Cameras on a body; other sensors lead to a note.

    Args:
        is_there: Whether the body is an object; otherwise its cameras are fixed in the world.
    """
    found: list[CameraSpec] = []
    for link in body.links:
        for sensor in link.element.findall("sensor"):
            kind = sensor.get("type").strip()
            if kind in KINDS:
                found.append(_camera(body, link, sensor, notes, is_there=is_there))
            else:
                notes.add(
                    sensor.place,
                    f"a sensor of the type '{kind}' is left out: only cameras are supported",
                )
    return found


def _camera(
    body: SdfBody, link: SdfLink, sensor: XmlElement, notes: Notes, *, is_there: bool
) -> CameraSpec:
    """The camera, named after the sensor."""
    note_unread_elements(sensor, "sensor", notes)
    words: dict[str, Any] = {"name": sensor.need("name").strip()[:100]}
    camera = sensor.find("camera")
    pose = link.scope.in_world() @ link.scope.pose_in(
        pose_of(sensor), link.element.need("name").strip()
    )
    rate = number(sensor, "update_rate", 0.0)
    if rate > 0:  # 0 is unlimited
        words["update_rate"] = min(rate, FASTEST)
    if camera is not None:
        note_unread_elements(camera, "camera", notes)
        pose = pose @ pose_of(camera).pose
        words |= _optics(camera, notes)
    if is_there:
        place = pose_spec(body.pose.inverse() @ pose)
        words["pose"] = place.model_copy(update={"frame": body.name})
    else:
        words["pose"] = pose_spec(pose)
    return validated(CameraSpec, words, sensor)


def _optics(camera: XmlElement, notes: Notes) -> dict[str, Any]:
    words: dict[str, Any] = {}
    angle = camera.find("horizontal_fov")
    if angle is not None:
        (value,) = numbers_of(angle, 1)
        if not NARROWEST <= value <= WIDEST:
            limits = f"{math.degrees(NARROWEST):.1f} to {math.degrees(WIDEST):.0f} degrees"
            angle.refuse(
                f"a pinhole camera cannot have a field of view of {value:g} rad", f"here: {limits}"
            )
        words["horizontal_fov"] = value
    image = camera.find("image")
    if image is not None:
        note_unread_elements(image, "image", notes)
        words["image"] = {
            **{side: _pixels(image, side) for side in ("width", "height") if image.find(side)},
            **_format(image, notes),
        }
    clip = camera.find("clip")
    if clip is not None:
        note_unread_elements(clip, "clip", notes)
        near, far = number(clip, "near", 0.1), number(clip, "far", 100.0)
        if not 0 < near < far:
            clip.refuse(f"<near> ({near:g} m) is above 0 and less than <far> ({far:g} m)")
        words["clip"] = {"near": near, "far": far}
    noise = camera.find("noise")
    if noise is not None:
        note_unread_elements(noise, "noise", notes)
        words["noise"] = _noise(noise)
    frame = text_of(camera, "optical_frame_id")
    return words | ({"optical_frame_id": frame} if frame else {})


def _pixels(image: XmlElement, side: str) -> int:
    element = image.find(side)
    assert element is not None
    (value,) = numbers_of(element, 1)
    if value != int(value) or not PIXELS[0] <= value <= PIXELS[1]:
        element.refuse(f"a picture's {side} is {PIXELS[0]} to {PIXELS[1]} pixels, not {value:g}")
    return int(value)


def _format(image: XmlElement, notes: Notes) -> dict[str, str]:
    name = text_of(image, "format", "R8G8B8")
    if name not in FORMATS:
        notes.add(image.place, f"the image format {name[:40]} is taken as R8G8B8")
    return {"format": FORMATS.get(name, "R8G8B8")}


def _noise(noise: XmlElement) -> dict[str, Any]:
    kind = text_of(noise, "type", "none")
    if kind not in ("gaussian", "gaussian_quantized", "none"):
        noise.refuse(f"the noise type `{kind[:40]}` is not known", "kinds: gaussian, none")
    mean, deviation = number(noise, "mean", 0.0), number(noise, "stddev", 0.0)
    if not (-1 <= mean <= 1 and 0 <= deviation <= 1):
        noise.refuse("noise is a share of full white: mean -1 to 1, stddev 0 to 1")
    return {"type": "none" if kind == "none" else "gaussian", "mean": mean, "stddev": deviation}
