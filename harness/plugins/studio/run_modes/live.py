"""`harness run --live`: a page shows the cases while they run."""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import ClassVar

from harness.cli.commands.view import open_browser
from harness.cli.output import complain
from harness.cli.run_mode import RunCall, RunFiles, RunMode
from harness.plugins.studio.commands.studio import refuse_missing_extra
from harness.suite.discovery import UsageError

LONGEST_WAIT_FOR_PAGE = 10.0  # [s]; then a run begins although its page is not open


class LiveMode(RunMode):
    """Show the cases on a page of this machine while they run."""

    name: ClassVar[str] = "live"

    def add_options(self, command: argparse.ArgumentParser) -> None:
        """Add `--live`."""
        text = "show the cases on a page of this machine while they run; needs the extra `studio`"
        command.add_argument("--live", action="store_true", help=text)

    def run(self, run_files: RunFiles, call: RunCall) -> int:
        """Run scenarios, with `--live` while a page shows them."""
        if not call.arguments.live:
            return run_files(call)
        for option, name in {"--on": "cluster", "--node": "nodes"}.items():
            if vars(call.arguments).get(name):
                raise UsageError(f"--live and {option} exclude each other")
        refuse_missing_extra()
        from harness.plugins.studio.watch import Watch

        with Watch() as watch:
            complain(f"live: {watch.page}")
            if open_browser(watch.page):
                watch.wait_for_page(LONGEST_WAIT_FOR_PAGE)
            return run_files(replace(call, hooks=replace(call.hooks, live=watch.address)))
