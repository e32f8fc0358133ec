"""`harness view`: the page of a run, in a browser."""

from __future__ import annotations

import argparse
import os
import webbrowser
from pathlib import Path
from typing import ClassVar

from harness.cli.command import RESULTS, Command
from harness.cli.output import complain, say
from harness.suite.discovery import UsageError


class ViewCommand(Command):
    """Open the page of a run."""

    name: ClassVar[str] = "view"
    group: ClassVar[str] = RESULTS
    reads_geometry: ClassVar[bool] = True

    def add_options(self, command: argparse.ArgumentParser) -> None:
        add = command.add_argument
        text = "the run's report folder, or a file in it; append '#t=10.1' to open that moment"
        add("run", metavar="RUN", help=text)
        add("--rebuild", action="store_true", help="write the page again from the saved run")
        add("--no-open", action="store_true", help="print the path of the page and open no browser")

    def run(self, arguments: argparse.Namespace) -> int:
        name, mark, place = arguments.run.partition("#")
        page = _page(Path(name), is_rebuilt=arguments.rebuild)
        say(f"{page}{mark}{place}")
        if arguments.no_open:
            return 0
        address = f"{page.resolve().as_uri()}{mark}{place}"
        if not open_browser(address):
            complain(f"no browser could be opened here; open {address}")
        return 0


def _page(path: Path, *, is_rebuilt: bool) -> Path:
    """A run's page, or the page of a folder of many runs."""
    from harness.recording.stored_run import PAGE, RUN
    from harness.reporting.suite import write as suite

    folder = path if path.is_dir() else path.parent
    if not path.exists() or not (folder / RUN).is_file():
        if all((folder / name).is_file() for name in (suite.PAGE, suite.RESULTS)):
            return folder / suite.PAGE
        below = next(folder.glob(f"**/{RUN}"), None) if path.is_dir() else None
        hint = f"; there is a run in '{below.parent}'" if below else ""
        raise UsageError(f"'{path}' is not the folder of a run: it has no {RUN}{hint}")
    page = folder / PAGE
    if is_rebuilt or not page.is_file():
        from harness.reporting.html.write import write_page

        write_page(folder)
    return page


def open_browser(address: str) -> bool:
    """Open a page where a browser has a screen; one in the terminal would take that over."""
    screens = ("BROWSER", "DISPLAY", "WAYLAND_DISPLAY", "WSL_DISTRO_NAME")
    has_screen = os.name == "nt" or os.uname().sysname == "Darwin"
    return (has_screen or any(map(os.environ.get, screens))) and webbrowser.open(address)
