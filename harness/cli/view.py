"""`harness view`: the page of a run, in a browser."""

from __future__ import annotations

import argparse
import os
import webbrowser
from pathlib import Path

from harness.cli.output import complain, guarded, say
from harness.suite.discovery import UsageError


def run(arguments: argparse.Namespace) -> int:
    """Find the page of a run, write it if it is not there, open it."""
    return guarded(lambda: _run(arguments))


def _run(arguments: argparse.Namespace) -> int:
    name, mark, place = arguments.run.partition("#")
    page = _page(Path(name), is_rebuilt=arguments.rebuild)
    say(f"{page}{mark}{place}")
    if arguments.no_open:
        return 0
    address = f"{page.resolve().as_uri()}{mark}{place}"
    if not has_browser() or not webbrowser.open(address):
        complain(f"no browser could be opened here; open {address}")
    return 0


def _page(path: Path, *, is_rebuilt: bool) -> Path:
    """A run's page, or the page of a folder of many runs."""
    from harness.recording.store import PAGE, RUN
    from harness.reporting.suite import write as suite

    folder = path if path.is_dir() else path.parent
    if not path.exists() or not (folder / RUN).is_file():
        if all((folder / name).is_file() for name in (suite.PAGE, suite.RESULTS)):
            return folder / suite.PAGE
        below = next(folder.glob(f"**/{RUN}"), None) if path.is_dir() else None
        hint = f"; a run is in '{below.parent}'" if below else ""
        raise UsageError(f"'{path}' is no run's folder: it has no {RUN}{hint}")
    page = folder / PAGE
    if is_rebuilt or not page.is_file():
        from harness.reporting.html.write import write_page

        write_page(folder)
    return page


def has_browser() -> bool:
    """Whether a browser has a screen to open on; one in the terminal would take it over."""
    screens = ("BROWSER", "DISPLAY", "WAYLAND_DISPLAY", "WSL_DISTRO_NAME")
    return os.name == "nt" or os.uname().sysname == "Darwin" or any(map(os.environ.get, screens))
