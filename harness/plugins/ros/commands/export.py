"""`harness export`: a saved run as files that other tools open."""

from __future__ import annotations

import argparse
import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from harness.cli.arguments import output_path, positive_number
from harness.cli.command import RESULTS, Command
from harness.cli.files import refuse_existing, refusing_unwritable, run_folder, write_text
from harness.cli.output import say
from harness.suite.discovery import UsageError

if TYPE_CHECKING:
    from harness.plugins.ros.bag.write import BagOptions
    from harness.recording.stored_run import StoredRun

METADATA = "metadata.yaml"


class ExportCommand(Command):
    """Write a saved run as a rosbag2, and its robot as a URDF."""

    name: ClassVar[str] = "export"
    group: ClassVar[str] = RESULTS
    reads_geometry: ClassVar[bool] = True

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness export`."""
        add = command.add_argument
        add("run", metavar="RUN", help="the run's report folder")
        add("--bag", metavar="DIR", type=output_path, help="write a rosbag2 into this new folder")
        add("--urdf", metavar="FILE", type=output_path, help="write the robot's URDF")
        text = "store the bag in this format (default: mcap, compressed)"
        add("--storage", choices=("mcap", "sqlite3"), default="mcap", help=text)
        text = "write joints, frames and clock at this rate (default: 100)"
        rate = positive_number("messages a second")
        add("--rate", metavar="HZ", type=rate, default=100.0, help=text)
        text = "write the cameras' pictures uncompressed too"
        add("--raw-images", action="store_true", help=text)
        text = "how the URDF names mesh files: as package://, or where they are on this machine"
        add("--meshes", choices=("package", "file"), default="package", help=text)
        add("--force", action="store_true", help="overwrite what exists")

    def run(self, arguments: argparse.Namespace) -> int:
        """Write the bag, the URDF, or both; all or nothing."""
        folder = run_folder(arguments.run)
        if not arguments.bag and not arguments.urdf:
            raise UsageError("nothing to export: say --bag DIR, --urdf FILE, or both")
        targets = [Path(name) for name in (arguments.bag, arguments.urdf) if name]
        for target in targets:
            _refuse_taken(target, is_forced=arguments.force)
        from harness.recording.read_run import read_run
        from harness.recording.stored_run import blames_changes

        stored = read_run(folder)
        with blames_changes(folder, stored):
            _export(arguments, stored)
        return 0


def _export(arguments: argparse.Namespace, stored: StoredRun) -> None:
    from harness.plugins.ros.bag.urdf import urdf_of
    from harness.plugins.ros.bag.write import BagOptions

    options = BagOptions(arguments.storage, arguments.rate, arguments.raw_images, arguments.meshes)
    if arguments.bag:
        bag = Path(arguments.bag)
        _write_bag(bag, stored, options)
        size = sum(file.stat().st_size for file in bag.iterdir())
        say(f"wrote {bag}: {size / 1e6:.1f} MB")
    if arguments.urdf:
        write_text(Path(arguments.urdf), urdf_of(stored.run, options.meshes))
        say(f"wrote {arguments.urdf}")


def _refuse_taken(target: Path, *, is_forced: bool) -> None:
    """Only a bag is replaced by a bag, and only with --force."""
    refuse_existing(target, is_forced=is_forced)
    if target.is_dir() and not (target / METADATA).is_file():
        raise UsageError(f"'{target}' is a folder and no bag; it is not replaced")


def _write_bag(bag: Path, stored: StoredRun, options: BagOptions) -> None:
    """Write the bag next to its place, then move it there."""
    from harness.plugins.ros.bag.write import write_bag

    with refusing_unwritable():
        bag.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=bag.parent, prefix=f".{bag.name}.") as place:
            written = Path(place) / bag.name
            write_bag(written, stored, options)
            if bag.is_dir():
                shutil.rmtree(bag)
            elif bag.exists():
                bag.unlink()
            written.rename(bag)
