"""Writes a loaded scenario as a file of its own: parameters, overrides and seed applied."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from harness.language.files.source import Entry, Loc, Located, Source, SourceMap
from harness.language.files.yaml_file import parse_yaml
from harness.language.files.yaml_text import yaml_text
from harness.language.reading.load import LoadedScenario
from harness.language.reading.params import PARAMS, escaped
from harness.language.reading.paths import paths_from
from harness.language.reading.short_forms import models_shape
from harness.language.scenario import Scenario
from harness.language.variation import VARIATION_KEYS

BLOCK_KEYS = ("steps", "during", "expect")  # their lists begin a line for each item


def resolved_text(
    loaded: LoadedScenario,
    step_seeds: Mapping[Loc, int] | None = None,
    *,
    folder: Path | None = None,
) -> str:
    """The scenario as YAML in the file's own short forms; loads to an equal scenario.

    Args:
        step_seeds: Path of a step in the model -> its seed, written above it as a comment.
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
    return _with_comments(yaml_text(root, block_keys=BLOCK_KEYS), step_seeds or {})


def _with_comments(text: str, seeds: Mapping[Loc, int]) -> str:
    if not seeds:
        return text
    source = Source.of_text("", text)
    lines = SourceMap(models_shape(parse_yaml(text, source), Scenario, []))
    comments: dict[int, list[str]] = {}
    for loc, seed in seeds.items():
        number, _ = lines.line_of(loc)
        comments.setdefault(number, []).append(f"# seed {seed}")
    written: list[str] = []
    for number, line in enumerate(text.splitlines(), start=1):
        indent = " " * (len(line) - len(line.lstrip(" ")))
        written += [indent + comment for comment in comments.get(number, [])]
        written.append(line)
    return "\n".join(written) + "\n"
