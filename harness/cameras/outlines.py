"""Number of pixels that an object has without occlusion and beyond the picture's edges."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import mujoco
import numpy as np

from harness.cameras.picture_model import SOLID_GROUP, TRANSLUCENT_GROUP, PictureModel
from harness.cameras.viewpoint import View

REACH = 1.0
"""Distance beyond each edge up to which pixels are counted, in picture sizes."""

MOST_RAYS = 60_000
"""Most rays for one object; a larger outline is sampled at every second, third ... pixel."""


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
    """Pixels [left, right) x [top, bottom) that contain the geoms' bounding spheres."""
    local = view.pose.inverse().apply(picture.data.geom_xpos[geoms])
    radii = picture.model.geom_rbound[geoms]
    depths = -local[:, 2]
    in_front = depths + radii > view.near
    if not in_front.any():
        return None
    local, radii, depths = local[in_front], radii[in_front], depths[in_front]
    if (depths - radii <= view.near).any():  # the camera is inside it
        low, high = np.array([-np.inf, -np.inf]), np.array([np.inf, np.inf])
    else:
        across = local[:, :2] * [1, -1]
        middle = np.arctan2(across, depths[:, None])
        half = np.arcsin(radii[:, None] / np.hypot(across, depths[:, None]))
        centre = [width / 2, height / 2]
        low = focal * np.tan(middle - half).min(axis=0) + centre
        high = focal * np.tan(middle + half).max(axis=0) + centre
    size = np.array([width, height])
    low = np.floor(np.maximum(low, -REACH * size)).astype(int)
    high = np.ceil(np.minimum(high, (1 + REACH) * size)).astype(int)
    if (low >= high).any():
        return None
    return int(low[0]), int(high[0]), int(low[1]), int(high[1])
