"""One way to draw, whatever the machine has: EGL, OSMesa, or rays on the processor."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from harness.cameras.gl_renderer import GLRenderer, gl_contexts
from harness.cameras.picture_model import PictureModel
from harness.cameras.ray_renderer import RayRenderer
from harness.cameras.viewpoint import View

Picture = np.ndarray
"""RGB, shape (height, width, 3), uint8."""


class Renderer(Protocol):
    """Draws a posed picture model.

    Attributes:
        backend: `egl`, `osmesa` or `rays`.
    """

    backend: str

    def render(self, view: View) -> Picture:
        """What is seen from a view."""
        ...

    def close(self) -> None:
        """Give back what the graphics library holds."""
        ...


def make_renderer(
    picture: PictureModel, width: int, height: int, backend: str = "auto"
) -> Renderer:
    """The best renderer that this machine can make.

    Args:
        picture: What is drawn.
        width: In pixels.
        height: In pixels.
        backend: `auto`, or the only one to try: `egl`, `osmesa`, `rays`.

    Raises:
        RuntimeError: The named backend is not there; `auto` always finds one.
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
