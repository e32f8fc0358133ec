"""One interface to three renderers: EGL and OSMesa off screen, and rays on the CPU."""

# pyright: reportAttributeAccessIssue=false, reportMissingImports=false

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np

from harness.core.types import FloatArray
from harness.plugins.cameras.picture_model import PictureModel
from harness.plugins.cameras.ray_renderer import RayRenderer
from harness.plugins.cameras.viewpoint import View, fit_viewpoint

MAX_GEOMS = 4000  # of a picture; MuJoCo allocates them in advance


def gl_contexts() -> tuple[tuple[str, Callable[[int, int], Any]], ...]:
    """Graphics libraries in order of preference, each with its context factory."""
    return ("egl", _egl_context), ("osmesa", _osmesa_context)


def _egl_context(width: int, height: int) -> Any:
    with _PyOpenGL("egl"):
        from mujoco.egl import GLContext

        return GLContext(width, height)


def _osmesa_context(width: int, height: int) -> Any:
    with _PyOpenGL("osmesa"):
        from mujoco.osmesa import GLContext

        return GLContext(width, height)


class _PyOpenGL:
    """Lets PyOpenGL load one platform, and unloads PyOpenGL when that fails.

    PyOpenGL chooses its library by an environment variable when it is first imported. MUJOCO_GL
    is never set: with it, importing mujoco itself fails on machines without the library.
    """

    VARIABLE = "PYOPENGL_PLATFORM"

    def __init__(self, platform: str) -> None:
        self._platform = platform
        self._before = os.environ.get(self.VARIABLE)

    def __enter__(self) -> None:
        os.environ.setdefault(self.VARIABLE, self._platform)

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if self._before is None:
            os.environ.pop(self.VARIABLE, None)
        if kind is not None:
            for name in [name for name in sys.modules if name.split(".")[0] == "OpenGL"]:
                del sys.modules[name]


class GLRenderer:
    """Draws with shadows, transparency and antialiasing."""

    def __init__(
        self, picture: PictureModel, width: int, height: int, backend: str, context: Any
    ) -> None:
        self.backend = backend
        self._picture = picture
        self._gl = context
        self._gl.make_current()
        model = picture.model
        self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._scene = mujoco.MjvScene(model, MAX_GEOMS)
        self._scene.flags[mujoco.mjtRndFlag.mjRND_HAZE] = True
        self._option = mujoco.MjvOption()
        self._viewport = mujoco.MjrRect(0, 0, width, height)

    def render(self, view: View) -> np.ndarray:
        """The picture of a view, RGB."""
        model, data = self._picture.model, self._picture.data
        camera = mujoco.MjvCamera()
        camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
        camera.fixedcamid = self._picture.eye
        model.cam_fovy[self._picture.eye] = view.field_of_view
        data.cam_xpos[self._picture.eye] = view.pose.translation
        data.cam_xmat[self._picture.eye] = view.pose.rotation.ravel()
        model.vis.map.znear = view.near / model.stat.extent
        model.vis.map.zfar = view.far / model.stat.extent
        everything = mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateScene(model, data, self._option, None, camera, everything, self._scene)
        mujoco.mjr_render(self._viewport, self._scene, self._context)
        picture = np.empty((self._viewport.height, self._viewport.width, 3), dtype=np.uint8)
        mujoco.mjr_readPixels(picture, None, self._viewport, self._context)
        return np.ascontiguousarray(picture[::-1])

    def close(self) -> None:
        """Free the graphics context."""
        self._context.free()
        self._gl.free()


Picture = np.ndarray  # RGB, shape (height, width, 3), uint8


Renderer = GLRenderer | RayRenderer
"""Draws a posed picture model; its `backend` is `egl`, `osmesa` or `rays`."""


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
) -> Picture:
    """A picture of a posed model, in a view that contains all given spheres.

    Args:
        points: Centres of the spheres, shape (N, 3) [m].
        radii: Radii of the spheres, shape (N,) [m].
        width: Width of the picture [pixels].
        height: Height of the picture [pixels].
    """
    renderer = make_renderer(picture, width, height)
    try:
        return renderer.render(fit_viewpoint(points, radii, width, height).view)
    finally:
        renderer.close()
