"""What cameras saw, small enough for the page."""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import Any

from harness.core.picture_files import colours, resized, webp
from harness.recording.drawings import Drawings
from harness.recording.run import Run
from harness.recording.stored_run import StoredRun
from harness.reporting.html.packing import Packer

KINDS = {"color": "", "depth_preview": "depth", "segmentation_preview": "segmentation"}
"""Kinds of files that can be looked at, and how the page calls them."""
WIDEST_VIDEO = 320  # [pixels], in the page; the file in the folder has the camera's size
LARGEST_VIDEO = 1_500_000  # a larger one stays in the run's folder [bytes]
MOST_IMAGES = 40  # of a camera in the page, each of about 30 kB; the folder has all
WIDEST = 480  # [pixels]
QUALITY = 75  # [%] of WebP


def pack_cameras(stored: StoredRun, packer: Packer) -> list[dict[str, Any]]:
    """Put videos and pictures in; a view for each camera and kind of picture."""
    return [*_videos(stored.drawings, packer), *_images(stored.run, packer)]


def _videos(drawings: Drawings, packer: Packer) -> list[dict[str, Any]]:
    if not drawings.videos:
        return []
    from harness.recording import film  # loads a video library

    views: list[dict[str, Any]] = []
    for number, video in enumerate(drawings.videos):
        data = drawings.files.get(video.file, b"")
        if not data or not video.times:
            continue
        if video.width > WIDEST_VIDEO or not video.file.endswith(film.SUFFIX):
            size = film.film_size(video.width, video.height, WIDEST_VIDEO)
            data = film.encoded_film(film.decoded_film(data), video.rate, size)
        if len(data) > LARGEST_VIDEO:
            continue
        name = packer.add(f"video.{number}", data)
        source = {"buffer": name, "type": film.MEDIA_TYPE, "start": video.times[0]}
        views.append(
            {"name": video.camera, "note": _note(video.backend), "video": source, "images": []}
        )
    return views


def _images(run: Run, packer: Packer) -> list[dict[str, Any]]:
    views: dict[tuple[str, str], dict[str, Any]] = {}
    for number, capture in enumerate(run.captures):
        for kind, called in KINDS.items():
            data = run.files.get(capture.files.get(kind, ""), b"")
            view = views.setdefault(
                (capture.camera, kind),
                {
                    "name": f"{capture.camera} {called}".strip(),
                    "note": _note(capture.backend),
                    "video": None,
                    "images": [],
                },
            )
            if not data or len(view["images"]) >= MOST_IMAGES:
                continue
            small, suffix = _small(data, PurePosixPath(capture.files[kind]).suffix)
            view["images"].append(
                {
                    "time": capture.time,
                    "buffer": packer.add(f"image.{number}.{kind}", small),
                    "type": f"image/{suffix.removeprefix('.').replace('jpg', 'jpeg')}",
                    "label": capture.step,
                }
            )
    return [view for view in views.values() if view["images"]]


def _note(backend: str) -> str:
    return f"drawn by {backend}" if backend else ""


def _small(data: bytes, suffix: str) -> tuple[bytes, str]:
    """The picture as WebP where that is smaller."""
    picture = colours(data)
    if picture is None:
        return data, suffix.lower()
    height, width = picture.shape[:2]
    if width > WIDEST:
        picture = resized(picture, WIDEST, round(height * WIDEST / width))
    small = webp(picture, QUALITY)
    return (small, ".webp") if len(small) < len(data) else (data, suffix.lower())
