"""The options of a pytest session, and the fork server that its scenarios share."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from harness.suite.warm import WarmServer

MARGIN = "harness_margin"  # attribute of a test report that holds the worst margin in words
RECORD = "harness_record"  # attribute of a test report that holds an item's record as plain data

SERVER = pytest.StashKey["WarmServer"]()


def report_root(config: pytest.Config) -> Path | None:
    """The folder for the session's reports; None when no reports are written."""
    if config.getoption("--harness-no-report"):
        return None
    folder = config.getoption("--harness-report-dir")
    return Path(folder) if folder else config.rootpath / config.getini("harness_report_dir")


def hard_cap(config: pytest.Config) -> float | None:
    """Wall time after which a scenario ends as an error [s]; None for the default."""
    cap = config.getini("harness_hard_cap")
    return float(cap) if cap else None


def nodes_of(config: pytest.Config) -> dict[str, str]:
    """Commands by name that scenarios may start as ROS 2 nodes."""
    given = [*config.getini("harness_nodes"), *(config.getoption("--harness-node") or ())]
    if not given:
        return {}
    from harness.session.run_request import named_commands

    return named_commands(given)


def server_of(config: pytest.Config) -> WarmServer:
    """The fork server of this pytest process, which ends together with pytest."""
    if SERVER not in config.stash:
        from harness.suite.warm import WarmServer  # only sessions with scenarios need it

        config.stash[SERVER] = server = WarmServer()
        config.add_cleanup(server.close)
    return config.stash[SERVER]


def shown(path: Path) -> Path:
    """The path relative to the working directory where that is possible."""
    here = Path.cwd()
    return path.relative_to(here) if path.is_relative_to(here) else path
