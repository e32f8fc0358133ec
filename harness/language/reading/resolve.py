"""Writes a loaded scenario as a file of its own: parameters, overrides and seed applied."""

from __future__ import annotations

from pathlib import Path

from harness.language.files.source import Entry, Located
from harness.language.files.yaml_text import yaml_text
from harness.language.reading.load import LoadedScenario
from harness.language.reading.params import PARAMS, escaped
from harness.language.reading.paths import paths_from
from harness.language.variation import VARIATION_KEYS

BLOCK_KEYS = ("steps", "during", "expect")  # their lists begin a line for each item


def resolved_text(loaded: LoadedScenario, *, folder: Path | None = None) -> str:
    """The scenario as YAML in the file's own short forms; loads to an equal scenario.

    Args:
        folder: Where the text will be saved; relative paths are written as from there (only
            then do they, alone, differ from the file's).
    """
    entries = {
        key: entry if key == PARAMS else Entry(entry.key, escaped(entry.value))
        for key, entry in loaded.written.mapping().items()
        if key not in VARIATION_KEYS
    }
    seed = Located(loaded.scenario.seed, loaded.written.place)
    entries["seed"] = Entry(seed.place, seed)
    root = Located(entries, loaded.written.place)
    if folder is not None:
        root = paths_from(root, loaded.path.parent, folder)
    return yaml_text(root, block_keys=BLOCK_KEYS)
