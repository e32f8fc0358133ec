"""`harness film`: the replay of a saved run as a video."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import ClassVar

from harness.cli.arguments import output_folder
from harness.cli.command import RESULTS, Command
from harness.cli.files import refusing_unwritable, run_folder
from harness.cli.output import say
from harness.cli.work_bar import WorkBar


class FilmCommand(Command):
    """Write the replay of a saved run as an MP4, and a picture of its deciding moment."""

    name: ClassVar[str] = "film"
    group: ClassVar[str] = RESULTS

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add the options of `harness film`."""
        command.add_argument("run", metavar="RUN", help="the report folder of a run")
        text = "the folder that gets film.mp4 and moment.jpg (default: the run's)"
        command.add_argument("--to", metavar="DIR", type=output_folder, default="", help=text)

    def run(self, arguments: argparse.Namespace) -> int:
        """Draw both files."""
        folder = run_folder(arguments.run)
        from harness.plugins.cameras.film import draw_film, draw_moment
        from harness.recording.files import write_file
        from harness.recording.read_run import read_run
        from harness.recording.stored_run import blames_changes
        from harness.suite.folders import refuse_unwritable

        stored, target = read_run(folder), Path(arguments.to or folder)
        refuse_unwritable(target)
        with blames_changes(folder, stored):
            files = {
                "film.mp4": draw_film(stored, activity=WorkBar()),
                "moment.jpg": draw_moment(stored),
            }
        with refusing_unwritable():
            target.mkdir(parents=True, exist_ok=True)
            for name, content in files.items():
                write_file(target / name, content)
                say(str(target / name))
        return 0
