"""One interface to three renderers: EGL, OSMesa, and rays on the CPU."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from harness.cameras.gl_renderer import GLRenderer, gl_contexts
from harness.cameras.picture_model import PictureModel
from harness.cameras.ray_renderer import RayRenderer
from harness.cameras.viewpoint import View, fit_viewpoint
from harness.core.types import FloatArray

Picture = np.ndarray
"""RGB, shape (height, width, 3), uint8."""


class Renderer(Protocol):
    """Draws a posed picture model.

    Attributes:
        backend: `egl`, `osmesa` or `rays`.
    """

    backend: str

    def render(self, view: View) -> Picture:
        """The picture of a view."""
        ...

    def close(self) -> None:
        """Free the resources of the graphics library."""
        ...


def make_renderer(
    picture: PictureModel, width: int, height: int, backend: str = "auto"
) -> Renderer:
    """The best renderer that this machine supports.

    Args:
        width: Width of the pictures [pixels].
        height: Height of the pictures [pixels].
        backend: `auto`, or the only one to try: `egl`, `osmesa`, `rays`.

    Raises:
        RuntimeError: The named backend is not available; `auto` always finds one.
    """
    for name, make_context in gl_contexts():
        if backend in ("auto", name):
            try:
                return GLRenderer(picture, width, height, name, make_context(width, height))
            except Exception as error:
                if backend == name:
                    raise RuntimeError(f"{name} cannot draw here: {error}") from error
    if backend not in ("auto", RayRenderer.backend):
        raise RuntimeError(f"no backend '{backend}'")
    return RayRenderer(picture, width, height)


def render_overview(
    picture: PictureModel,
    points: FloatArray,
    radii: FloatArray,
    width: int,
    height: int,
    backend: str = "auto",
) -> Picture:
    """A picture of a posed model, in a view that contains all given spheres.

    Args:
        points: Centres of the spheres, shape (N, 3) [m].
        radii: Radii of the spheres, shape (N,) [m].
        width: Width of the picture [pixels].
        height: Height of the picture [pixels].
        backend: The rendering backend, as in `make_renderer`.
    """
    renderer = make_renderer(picture, width, height, backend)
    try:
        return renderer.render(fit_viewpoint(points, radii, width, height).view)
    finally:
        renderer.close()
