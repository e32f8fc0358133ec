"""Number of pixels that an object has without occlusion and beyond the picture's edges."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from itertools import combinations, product

import mujoco
import numpy as np

from harness.plugins.cameras.picture_model import SOLID_GROUP, TRANSLUCENT_GROUP, PictureModel
from harness.plugins.cameras.viewpoint import View

REACH = 20.0
"""Distance beyond each edge up to which pixels are counted, in picture sizes: 87.6 degrees to each
side of a picture with a view of 60 degrees."""

MOST_RAYS = 60_000  # for one object; of a larger outline every second, third ... pixel counts


FAR = 1e3  # [m], half of the size that a plane is taken to have
SIGNS = np.array(list(product((-1.0, 1.0), repeat=3)))
EDGES = np.array([(a, b) for a, b in combinations(range(8), 2) if (a ^ b).bit_count() == 1])
"""Pairs of corners of a box that an edge connects."""

_BODIES = np.isin(np.arange(6), (SOLID_GROUP, TRANSLUCENT_GROUP)).astype(np.uint8)


def outline_pixels(picture: PictureModel, name: str, view: View, width: int, height: int) -> int:
    """Pixels of an unoccluded object in a view; 0 when it is not in front of the camera.

    Args:
        picture: The posed scene; rays meet the object's geoms alone.
        width: Width of the picture [pixels].
        height: Height of the picture [pixels].
    """
    model = picture.model
    geoms = np.arange(model.ngeom)[picture.geoms[name]]
    focal = 0.5 * height / np.tan(np.radians(view.field_of_view) / 2)
    box = _bounds(picture, geoms, view, focal, width, height)
    if box is None:
        return 0
    left, right, top, bottom = box
    stride = int(np.ceil(np.sqrt((right - left) * (bottom - top) / MOST_RAYS)))
    columns, rows = np.arange(left, right, stride), np.arange(top, bottom, stride)
    u, v = np.meshgrid(columns + 0.5 - width / 2, height / 2 - rows - 0.5)
    local = np.stack([u / focal, v / focal, -np.ones_like(u)], axis=-1).reshape(-1, 3)
    shown = model.geom_rgba[:, 3].copy()
    model.geom_rgba[:, 3] = 0.0
    model.geom_rgba[geoms, 3] = shown[geoms]
    hits, depths = np.empty(len(local), dtype=np.int32), np.empty(len(local))
    mujoco.mj_multiRay(
        model,
        picture.data,
        view.pose.translation,
        np.ascontiguousarray(local @ view.pose.rotation.T).ravel(),
        _BODIES,
        True,
        -1,
        hits,
        depths,  # in lengths of rays of depth 1
        None,
        len(local),
        view.far,
    )
    model.geom_rgba[:, 3] = shown
    return int(np.count_nonzero(hits >= 0)) * stride * stride


def _bounds(
    picture: PictureModel,
    geoms: np.ndarray,
    view: View,
    focal: float,
    width: int,
    height: int,
) -> tuple[int, int, int, int] | None:
    """Pixels [left, right) x [top, bottom) that contain the geoms' bounding boxes."""
    points = [_before(view, _corners(picture, geom)) for geom in geoms]
    seen = np.concatenate(points)
    if not len(seen):
        return None
    places = focal * seen[:, :2] * [1, -1] / -seen[:, 2:] + [width / 2, height / 2]
    low, high = places.min(axis=0), places.max(axis=0)
    size = np.array([width, height])
    low = np.floor(np.maximum(low, -REACH * size)).astype(int)
    high = np.ceil(np.minimum(high, (1 + REACH) * size)).astype(int)
    if (low >= high).any():
        return None
    return int(low[0]), int(high[0]), int(low[1]), int(high[1])


def _corners(picture: PictureModel, geom: int) -> np.ndarray:
    """Corners of a geom's bounding box in the world [m], shape (8, 3)."""
    middle, half = np.split(picture.model.geom_aabb[geom], 2)
    half = np.where(half > 0, half, FAR)  # a plane has no size
    corners = middle + half * SIGNS
    rotation = picture.data.geom_xmat[geom].reshape(3, 3)
    return corners @ rotation.T + picture.data.geom_xpos[geom]


def _before(view: View, corners: np.ndarray) -> np.ndarray:
    """Corners of the part of a box that is in front of the camera, in its frame [m], (n, 3)."""
    local = view.pose.inverse().apply(corners)
    ahead = -local[:, 2] - view.near
    begins, ends = EDGES[:, 0], EDGES[:, 1]
    cut = ahead[begins] * ahead[ends] < 0
    begins, ends = begins[cut], ends[cut]
    share = (ahead[begins] / (ahead[begins] - ahead[ends]))[:, None]
    crossings = local[begins] + share * (local[ends] - local[begins])
    return np.concatenate([local[ahead >= 0], crossings])
