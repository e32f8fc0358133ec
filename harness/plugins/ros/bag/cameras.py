"""Pictures of the run's cameras: compressed, raw where one was captured, with their calibration."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import Any

import numpy as np

from harness.core.camera import Camera
from harness.core.limits import PICTURE_PIXELS
from harness.core.picture_files import colours, decoded, grey, jpeg, resized
from harness.plugins.ros.bag.frames import optical_frames
from harness.plugins.ros.bag.messages import header, message
from harness.plugins.ros.bag.samples import Message
from harness.plugins.ros.bag.topics import camera_topics
from harness.recording.film import decoded_film
from harness.recording.npz_file import NpzFile
from harness.recording.run import Run
from harness.recording.signals import CaptureRecord, VideoRecord
from harness.recording.stored_run import StoredRun

MAGIC = {b"\xff\xd8": "jpeg", b"\x89P": "png"}


def captures(run: Run) -> Iterator[Message]:
    """The pictures that `capture` steps took: compressed as they are, raw, and their depth."""
    cameras = {camera.name: camera for camera in run.cameras}
    frames = optical_frames(run.cameras, run.signals.object_poses)
    for capture in run.captures:
        camera = cameras[capture.camera]
        topics, head = camera_topics(camera.name), header(capture.time, frames[camera.name])
        yield Message(capture.time, topics.info, camera_info(camera, head))
        if "color" in capture.files:
            content = run.files[capture.files["color"]]
            compressed = compressed_image(content, camera, head)
            yield Message(capture.time, topics.compressed, compressed)
            yield Message(capture.time, topics.image, _raw(content, camera, head))
        if "depth" in capture.files:
            yield Message(capture.time, topics.depth, _depth(run, capture, head))


def video_frames(
    stored: StoredRun, video: VideoRecord, *, is_raw: bool = False
) -> Iterator[Message]:
    """Every frame of the video of a camera that was recorded all along, as its JPEG pictures.

    Args:
        is_raw: Publish the frames uncompressed too.
    """
    run = stored.run
    camera = next(camera for camera in run.cameras if camera.name == video.camera)
    topics = camera_topics(camera.name)
    frame = optical_frames(run.cameras, run.signals.object_poses)[camera.name]
    pictures = decoded_film(stored.drawings.files[video.file])
    for time, picture in zip(video.times, pictures, strict=False):  # one that is cut off has less
        content, head = _jpeg(picture, camera), header(time, frame)
        yield Message(time, topics.info, camera_info(camera, head))
        yield Message(time, topics.compressed, compressed_image(content, camera, head))
        if is_raw:
            yield Message(time, topics.image, _raw(content, camera, head))


def _jpeg(picture: np.ndarray[Any, Any], camera: Camera) -> bytes:
    """A picture of a video as the camera delivers it compressed."""
    if picture.shape[:2] != (camera.height, camera.width):  # odd sizes are even in a video
        picture = resized(picture, camera.width, camera.height)
    return jpeg(grey(picture) if camera.is_grey else picture, camera.jpeg_quality)


def compressed_image(content: bytes, camera: Camera, header: Any) -> Any:
    """A CompressedImage with the format as compressed_image_transport writes it."""
    kind = MAGIC.get(content[:2], "png")
    source, stored = ("mono8", "mono8") if camera.is_grey else ("rgb8", "bgr8")
    data = np.frombuffer(content, np.uint8)
    encoding = f"{source}; {kind} compressed {stored}"
    return message("sensor_msgs/msg/CompressedImage", header=header, format=encoding, data=data)


def _raw(content: bytes, camera: Camera, header: Any) -> Any:
    picture = decoded(content) if camera.is_grey else colours(content)
    if picture is None:
        raise ValueError(f"a picture of {camera.name} cannot be decoded")
    return image(picture, header)


def _depth(run: Run, capture: CaptureRecord, header: Any) -> Any:
    with NpzFile(io.BytesIO(run.files[capture.files["depth"]]), 4 * PICTURE_PIXELS) as archive:
        return image(archive.read("depth").astype("<f4"), header)


def image(picture: np.ndarray[Any, Any], header: Any) -> Any:
    """An Image: colour, shape (h, w, 3), grey levels, shape (h, w), or depth in float32 [m]."""
    encoding = "32FC1" if picture.dtype == np.float32 else "rgb8" if picture.ndim == 3 else "mono8"
    data = np.ascontiguousarray(picture).view(np.uint8).reshape(-1)
    height, width = picture.shape[:2]
    return message(
        "sensor_msgs/msg/Image", header=header, height=height, width=width, encoding=encoding,
        step=data.size // height, data=data,
    )  # fmt: skip


def camera_info(camera: Camera, header: Any) -> Any:
    """The CameraInfo of a pinhole without distortion."""
    projection = np.hstack([camera.matrix, np.zeros((3, 1))])
    return message(
        "sensor_msgs/msg/CameraInfo", header=header, height=camera.height, width=camera.width,
        distortion_model="plumb_bob", d=np.zeros(5), k=camera.matrix.reshape(-1),
        r=np.eye(3).reshape(-1), p=projection.reshape(-1),
    )  # fmt: skip
