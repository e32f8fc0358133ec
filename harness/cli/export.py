"""`harness export`: a saved run as files that other tools open."""

from __future__ import annotations

import argparse
import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from harness.cli.output import guarded, say
from harness.suite.discovery import UsageError

if TYPE_CHECKING:
    from harness.recording.store import StoredRun
    from harness.reporting.rosbag.write import BagOptions

METADATA = "metadata.yaml"


def run(arguments: argparse.Namespace) -> int:
    """Write the bag, the URDF, or both; all or nothing."""
    return guarded(lambda: _run(arguments))


def _run(arguments: argparse.Namespace) -> int:
    from harness.recording.store import RUN

    path = Path(arguments.run)
    folder = path if path.is_dir() else path.parent
    if not path.exists() or not (folder / RUN).is_file():
        raise UsageError(f"'{arguments.run}' is no run's folder: it has no {RUN}")
    if not arguments.bag and not arguments.urdf:
        raise UsageError("nothing to export: say --bag DIR, --urdf FILE, or both")
    targets = [Path(name) for name in (arguments.bag, arguments.urdf) if name]
    for target in targets:
        _refuse_taken(target, is_forced=arguments.force)
    from harness.recording.store import blames_changes, read_run

    stored = read_run(folder)
    with blames_changes(folder, stored):
        _export(arguments, stored)
    return 0


def _export(arguments: argparse.Namespace, stored: StoredRun) -> None:
    from harness.reporting.rosbag.urdf import urdf_of
    from harness.reporting.rosbag.write import BagOptions

    options = BagOptions(arguments.storage, arguments.rate, arguments.raw_images, arguments.meshes)
    if arguments.bag:
        bag = Path(arguments.bag)
        _write_bag(bag, stored, options)
        size = sum(file.stat().st_size for file in bag.iterdir())
        say(f"wrote {bag}: {size / 1e6:.1f} MB")
    if arguments.urdf:
        _write_text(Path(arguments.urdf), urdf_of(stored.run, options.meshes))
        say(f"wrote {arguments.urdf}")


def _refuse_taken(target: Path, *, is_forced: bool) -> None:
    """Only a bag is replaced by a bag, and only with --force."""
    if not target.exists():
        return
    if not is_forced:
        raise UsageError(f"'{target}' is there already; nothing was written (--force overwrites)")
    if target.is_dir() and not (target / METADATA).is_file():
        raise UsageError(f"'{target}' is a folder and no bag; it is not replaced")


def _write_bag(bag: Path, stored: StoredRun, options: BagOptions) -> None:
    """Write it next to its place, then move it there."""
    from harness.reporting.rosbag.write import write_bag

    try:
        bag.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=bag.parent, prefix=f".{bag.name}.") as place:
            written = Path(place) / bag.name
            write_bag(written, stored, options)
            if bag.is_dir():
                shutil.rmtree(bag)
            elif bag.exists():
                bag.unlink()
            written.rename(bag)
    except OSError as error:
        raise UsageError(f"cannot write '{error.filename}': {error.strerror}") from error


def _write_text(path: Path, text: str) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="")
    except OSError as error:
        raise UsageError(f"cannot write '{error.filename}': {error.strerror}") from error
