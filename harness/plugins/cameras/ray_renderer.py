"""A renderer without a graphics library: MuJoCo casts one ray per pixel on the CPU."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from dataclasses import dataclass, replace

import mujoco
import numpy as np

from harness.plugins.cameras.picture_model import (
    FLOOR_COLOUR,
    FLOOR_GROUP,
    FLOOR_LINES,
    HORIZON,
    LIGHT_DIRECTION,
    SKY_TOP,
    SOLID_GROUP,
    TRANSLUCENT_GROUP,
    PictureModel,
)
from harness.plugins.cameras.viewpoint import View

LIGHT_DISTANCE = 30.0  # [m], of the sun, which is a point light
FLOOR_SPACING, LINE_WIDTH = 0.5, 0.006  # [m], of the floor's grid
FADE = 9.0  # [m], over which the floor fades into the horizon
AMBIENT, HEAD, SUN = 0.48, 0.25, 0.42  # shares of light


_SOLID = np.isin(np.arange(6), (SOLID_GROUP, FLOOR_GROUP)).astype(np.uint8)


@dataclass(frozen=True, eq=False)
class _Rays:
    """Unit directions from one origin; a length times its cosine to the axis is a depth."""

    origin: np.ndarray
    directions: np.ndarray
    cosines: np.ndarray
    near: float
    far: float

    def chosen(self, which: np.ndarray) -> _Rays:
        """A subset of the rays."""
        return replace(self, directions=self.directions[which], cosines=self.cosines[which])


class RayRenderer:
    """Draws with hard shadows; oversampling averages edges over smaller pixels."""

    backend = "rays"

    def __init__(
        self, picture: PictureModel, width: int, height: int, oversampling: int = 1
    ) -> None:
        self._picture = picture
        self._oversampling = oversampling
        self._size = height * oversampling, width * oversampling
        self._local: dict[float, np.ndarray] = {}

    def render(self, view: View) -> np.ndarray:
        """The picture of a view, RGB."""
        model = self._picture.model
        rays = self._rays(view)
        colour, geoms = self._colour(rays, None)
        clear = geoms >= 0
        clear[clear] = model.geom_group[geoms[clear]] == TRANSLUCENT_GROUP
        if clear.any():
            alpha = model.geom_rgba[geoms[clear], 3, None]
            through, _ = self._colour(rays.chosen(clear), _SOLID)
            colour[clear] = alpha * colour[clear] + (1 - alpha) * through
        height, width = self._size
        step = self._oversampling
        blocks = colour.reshape(height // step, step, width // step, step, 3)
        return np.clip(255 * blocks.mean(axis=(1, 3)), 0, 255).astype(np.uint8)

    def measure(self, view: View) -> tuple[np.ndarray, np.ndarray]:
        """Depth along the axis [m] and geom of every pixel, shape (height, width) each.

        A pixel without a hit between near and far has depth inf and geom -1.
        """
        rays = self._rays(view)
        geoms, distances, _ = self._see(rays, None)
        depth = np.where(geoms >= 0, distances * rays.cosines, np.inf)
        return depth.reshape(self._size), geoms.reshape(self._size)

    def close(self) -> None:
        """Do nothing: the renderer holds no resources."""

    def _rays(self, view: View) -> _Rays:
        height, width = self._size
        local = self._local.get(view.field_of_view)
        if local is None:
            focal = 0.5 * height / np.tan(np.radians(view.field_of_view) / 2)
            u, v = np.meshgrid(
                (np.arange(width) + 0.5 - width / 2) / focal,
                (height / 2 - np.arange(height) - 0.5) / focal,
            )
            local = np.stack([u, v, -np.ones_like(u)], axis=-1).reshape(-1, 3)
            local /= np.linalg.norm(local, axis=1, keepdims=True)
            self._local = {view.field_of_view: local}
        directions = local @ view.pose.rotation.T
        return _Rays(view.pose.translation, directions, -local[:, 2], view.near, view.far)

    def _see(
        self, rays: _Rays, groups: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The hits that `_cast` returns between the near and the far plane.

        A ray passes through a geom that it enters before the near plane, as on graphics cards that
        cull back faces. The floor, geom 0, has none.
        """
        model = self._picture.model
        longest = rays.far / float(rays.cosines.min(initial=1.0))
        opacity = model.geom_rgba[:, 3].copy()
        model.geom_rgba[self._within(rays.origin, rays.near), 3] = (
            0.0  # usually the camera's own housing
        )
        geoms, distances, normals = self._cast(rays.origin, rays.directions, groups, longest)
        pending = np.flatnonzero((geoms > 0) & (distances * rays.cosines < rays.near))
        while len(pending):
            model.geom_rgba[np.unique(geoms[pending]), 3] = 0.0
            found = self._cast(rays.origin, rays.directions[pending], groups, longest)
            geoms[pending], distances[pending], normals[pending] = found
            too_near = (geoms[pending] > 0) & (
                distances[pending] * rays.cosines[pending] < rays.near
            )
            pending = pending[too_near]
        model.geom_rgba[:, 3] = opacity
        geoms[(geoms >= 0) & (distances * rays.cosines > rays.far)] = -1
        return geoms, distances, normals

    def _within(self, origin: np.ndarray, distance: float) -> np.ndarray:
        """Whether the whole geom is nearer than a distance, for every geom."""
        centres = np.linalg.norm(self._picture.data.geom_xpos - origin, axis=1)
        radii = self._picture.model.geom_rbound
        return (radii > 0) & (centres + radii <= distance)  # planes have a radius of 0

    def _cast(
        self,
        origin: np.ndarray,
        rays: np.ndarray,
        groups: np.ndarray | None,
        longest: float = 1e10,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Geom (-1: none), distance in ray lengths and surface normal of each ray's first hit."""
        count = len(rays)
        geoms, distances = np.empty(count, dtype=np.int32), np.empty(count)
        normals = np.empty(3 * count)
        mujoco.mj_multiRay(
            self._picture.model,
            self._picture.data,
            origin,
            np.ascontiguousarray(rays).ravel(),
            groups,
            True,
            -1,
            geoms,
            distances,
            normals,
            count,
            longest,
        )
        return geoms, distances, normals.reshape(-1, 3)

    def _colour(self, seen_from: _Rays, groups: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
        """Colour, shape (N, 3) in 0..1, and geom of each ray's first hit."""
        geoms, distances, normals = self._see(seen_from, groups)
        origin, rays = seen_from.origin, seen_from.directions
        rise = np.clip(rays[:, 2:], 0, 1)
        colour = (1 - rise) * np.array(HORIZON) + rise * np.array(SKY_TOP)
        hit = np.flatnonzero(geoms >= 0)
        points = origin + rays[hit] * distances[hit, None]
        base = self._picture.model.geom_rgba[geoms[hit], :3].copy()
        floor = geoms[hit] == 0
        base[floor] = _floor_colour(points[floor])
        facing = np.abs(np.einsum("ij,ij->i", normals[hit], rays[hit]))
        towards_sun = -np.array(LIGHT_DIRECTION) / np.linalg.norm(LIGHT_DIRECTION)
        turned = np.where(np.einsum("ij,ij->i", normals[hit], rays[hit]) > 0, -1.0, 1.0)
        sun = np.clip(turned * (normals[hit] @ towards_sun), 0, 1) * self._lit(points, towards_sun)
        shade = AMBIENT + HEAD * facing + SUN * sun
        drawn = np.clip(base * shade[:, None], 0, 1)
        fade = np.where(floor, np.clip(distances[hit] / FADE - 0.3, 0, 1), 0)[:, None]
        colour[hit] = (1 - fade) * drawn + fade * np.array(HORIZON)
        return colour, geoms

    def _lit(self, points: np.ndarray, towards_sun: np.ndarray) -> np.ndarray:
        """0 in shadow, 1 in the sun, for each point."""
        sun = LIGHT_DISTANCE * towards_sun
        to_points = points - sun
        _, distances, _ = self._cast(sun, to_points, _SOLID)
        return (distances < 0) | (distances > 1 - 0.003 / LIGHT_DISTANCE)


def _floor_colour(points: np.ndarray) -> np.ndarray:
    across = np.abs(points[:, :2] / FLOOR_SPACING - np.round(points[:, :2] / FLOOR_SPACING))
    on_line = across.min(axis=1, keepdims=True) < 0.5 * LINE_WIDTH / FLOOR_SPACING
    return np.where(on_line, FLOOR_LINES, FLOOR_COLOUR)
