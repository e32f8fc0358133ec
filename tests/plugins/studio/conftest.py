"""A studio that runs in this process, and pages of it in a real browser."""

import threading

import pytest

from harness.plugins.studio.document import new_text
from harness.plugins.studio.files import StudioFiles
from harness.plugins.studio.guard import Guard
from harness.plugins.studio.server import StudioServer, page_assets
from harness.plugins.studio.session import guarded
from harness.plugins.studio.studio import Studio
from tests.waiting import HANG


class Served:
    """A studio and its server.

    Attributes:
        address: Of the page.
    """

    def __init__(self, folder, text, *, is_open=False):
        self.files = StudioFiles(folder, folder / "open_manipulator_x_by_hand.scenario.yaml")
        self.studio = Studio.opened(self.files, text, None, "")
        self.guard = Guard.of(page_assets(), is_open=is_open)
        self.server = StudioServer("127.0.0.1", 0, self.guard, self.studio.session.handle)
        self.studio.open()
        self.port = self.server.port
        self.address = f"http://127.0.0.1:{self.port}/"

    def reply_to(self, action, **keys):
        """The reply to a request, given in the cell's thread as one of a page is."""
        done, replies = threading.Event(), []

        def job():
            replies.append(guarded(lambda: self.studio.do(action, keys)))
            done.set()

        self.studio.session.post(job)
        assert done.wait(HANG)
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
