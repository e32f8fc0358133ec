"""The reporter `rosbag`."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from harness.recording.stored_run import StoredRun
from harness.reporting.reporter import Reporter


class RosbagReporter(Reporter):
    """A rosbag2 in the folder `bag`; `--bag` is its short form."""

    name: ClassVar[str] = "rosbag"
    takes_argument: ClassVar[bool] = False
    package: ClassVar[str] = "rosbags"

    def write(self, folder: Path, stored: StoredRun) -> None:
        """Write the bag."""
        from harness.plugins.ros.bag.write import BAG, write_bag

        write_bag(folder / BAG, stored)
