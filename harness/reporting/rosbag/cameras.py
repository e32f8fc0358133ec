"""Pictures of the run's cameras: compressed, raw where one was captured, with their calibration."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import Any

import cv2
import numpy as np

from harness.core.camera import Camera
from harness.recording.film import decoded_film
from harness.recording.run import Run
from harness.recording.signals import CaptureRecord, VideoRecord
from harness.reporting.rosbag.frames import optical_frames
from harness.reporting.rosbag.messages import (
    CameraInfo,
    CompressedImage,
    Image,
    RegionOfInterest,
    header,
)
from harness.reporting.rosbag.samples import Message
from harness.reporting.rosbag.topics import camera_topics

MAGIC = {b"\xff\xd8": "jpeg", b"\x89P": "png"}


def captures(run: Run) -> Iterator[Message]:
    """The pictures that `capture` steps took: compressed as they are, raw, and their depth."""
    cameras = {camera.name: camera for camera in run.cameras}
    frames = optical_frames(run)
    for capture in run.captures:
        camera = cameras[capture.camera]
        topics, frame = camera_topics(camera.name), frames[camera.name]
        yield Message(capture.time, topics.info, _info(camera, capture.time, frame))
        if "color" in capture.files:
            content = run.files[capture.files["color"]]
            yield Message(
                capture.time, topics.compressed, _compressed(content, camera, capture.time, frame)
            )
            yield Message(capture.time, topics.image, _raw(content, camera, capture.time, frame))
        if "depth" in capture.files:
            yield Message(capture.time, topics.depth, _depth(run, capture, frame))


def video_frames(run: Run, video: VideoRecord, *, is_raw: bool = False) -> Iterator[Message]:
    """Every frame of the video of a camera that was recorded all along, as its JPEG pictures.

    Args:
        is_raw: Publish the frames uncompressed too.
    """
    camera = next(camera for camera in run.cameras if camera.name == video.camera)
    topics, frame = camera_topics(camera.name), optical_frames(run)[camera.name]
    pictures = decoded_film(run.files[video.file])
    for time, picture in zip(video.times, pictures, strict=False):  # one that is cut off has less
        content = _jpeg(picture, camera)
        yield Message(time, topics.info, _info(camera, time, frame))
        yield Message(time, topics.compressed, _compressed(content, camera, time, frame))
        if is_raw:
            yield Message(time, topics.image, _raw(content, camera, time, frame))


def _jpeg(picture: np.ndarray[Any, Any], camera: Camera) -> bytes:
    """A picture of a video as the camera delivers it compressed."""
    if picture.shape[:2] != (camera.height, camera.width):  # odd sizes are even in a video
        picture = cv2.resize(picture, (camera.width, camera.height))
    code = cv2.COLOR_RGB2GRAY if camera.is_grey else cv2.COLOR_RGB2BGR
    options = [cv2.IMWRITE_JPEG_QUALITY, camera.jpeg_quality]
    is_coded, content = cv2.imencode(".jpg", cv2.cvtColor(picture, code), options)
    if not is_coded:
        raise RuntimeError("OpenCV cannot write .jpg files here")
    return content.tobytes()


def _compressed(content: bytes, camera: Camera, time: float, frame: str) -> Any:
    """With the format as compressed_image_transport writes it."""
    kind = MAGIC.get(content[:2], "png")
    source, stored = ("mono8", "mono8") if camera.is_grey else ("rgb8", "bgr8")
    data = np.frombuffer(content, np.uint8)
    said = f"{source}; {kind} compressed {stored}"
    return CompressedImage(header=header(time, frame), format=said, data=data)


def _raw(content: bytes, camera: Camera, time: float, frame: str) -> Any:
    flag = cv2.IMREAD_GRAYSCALE if camera.is_grey else cv2.IMREAD_COLOR_RGB
    picture = cv2.imdecode(np.frombuffer(content, np.uint8), flag)
    if picture is None:
        raise ValueError(f"a picture of {camera.name} at t={time:.3f} s cannot be decoded")
    return _image(np.asarray(picture), "mono8" if camera.is_grey else "rgb8", time, frame)


def _depth(run: Run, capture: CaptureRecord, frame: str) -> Any:
    with np.load(io.BytesIO(run.files[capture.files["depth"]]), allow_pickle=False) as archive:
        depth = archive["depth"].astype("<f4")
    return _image(depth, "32FC1", capture.time, frame)


def _image(picture: np.ndarray[Any, Any], encoding: str, time: float, frame: str) -> Any:
    data = np.ascontiguousarray(picture).view(np.uint8).reshape(-1)
    height, width = picture.shape[:2]
    return Image(
        header=header(time, frame), height=height, width=width, encoding=encoding,
        is_bigendian=0, step=data.size // height, data=data,
    )  # fmt: skip


def _info(camera: Camera, time: float, frame: str) -> Any:
    """A pinhole without distortion."""
    projection = np.hstack([camera.matrix, np.zeros((3, 1))])
    return CameraInfo(
        header=header(time, frame), height=camera.height, width=camera.width,
        distortion_model="plumb_bob", d=np.zeros(5), k=camera.matrix.reshape(-1),
        r=np.eye(3).reshape(-1), p=projection.reshape(-1), binning_x=0, binning_y=0,
        roi=RegionOfInterest(x_offset=0, y_offset=0, height=0, width=0, do_rectify=False),
    )  # fmt: skip
