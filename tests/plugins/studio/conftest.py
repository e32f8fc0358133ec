"""A studio that runs in this process, and pages of it in a real browser."""

import threading

import numpy as np
import pytest

from harness.plugins.studio.document import new_text
from harness.plugins.studio.files import StudioFiles
from harness.plugins.studio.guard import Guard
from harness.plugins.studio.server import page_assets, start_server
from harness.plugins.studio.session import guarded
from harness.plugins.studio.studio import Studio


class Served:
    """A studio and its server.

    Attributes:
        address: Of the page.
    """

    def __init__(self, folder, text, *, is_open=False):
        self.files = StudioFiles(folder, folder / "open_manipulator_x_by_hand.scenario.yaml")
        self.studio = Studio.opened(self.files, text, None, "")
        self.guard = Guard.of(page_assets(), is_open=is_open)
        self.server = start_server("127.0.0.1", 0, self.guard, self.studio.session.handle)
        self.studio.open(self.server)
        self.port = self.server.get_port()
        self.address = f"http://127.0.0.1:{self.port}/"

    def reply_to(self, action, **keys):
        """The reply to a request, given in the cell's thread as one of a page is."""
        done, replies = threading.Event(), []

        def job():
            replies.append(guarded(lambda: self.studio.do(action, keys)))
            done.set()

        self.studio.session.post(job)
        assert done.wait(60)
        return replies[0]

    def close(self):
        self.studio.close()
        self.server.stop()


@pytest.fixture(scope="module")
def serve(tmp_path_factory):
    """Serves studios, which end with the module."""
    opened = []

    def begin(text=None, **options):
        folder = tmp_path_factory.mktemp("studio")
        text = text or new_text("by hand", {"model": "open_manipulator_x"}, "empty")
        opened.append(Served(folder, text, **options))
        return opened[-1]

    yield begin
    for each in opened:
        each.close()


def pixel_of(camera, size, point):
    """Where a point of the world is in viser's picture of some width and height."""
    from harness.core.spatial import SE3

    T_world_camera = SE3.from_xyz_quat(camera.position, camera.wxyz)
    x, y, z = T_world_camera.inverse().apply(np.array(point))
    scale = 0.5 * size[1] / np.tan(0.5 * camera.fov)
    return 0.5 * size[0] + scale * x / z, 0.5 * size[1] + scale * y / z
