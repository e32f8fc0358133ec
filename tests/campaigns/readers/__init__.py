"""Every reader of what others write: good files of it, and the call that reads a changed one."""

from tests.campaigns.reader import Reader
from tests.campaigns.readers import (
    classes,
    programs,
    recordings,
    robots,
    scenarios,
    suites,
    worlds,
)

KINDS = (scenarios, robots, worlds, recordings, suites, classes, programs)
READERS: dict[str, Reader] = {
    name: reader for kind in KINDS for name, reader in kind.READERS.items()
}
"""Readers by the names that the command takes."""
