"""Examples of steps and expectations for the reference: parts of the bundled scenarios."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from textwrap import indent

import yaml

from docs import ROOT
from harness.language.language import PREDICATES
from harness.language.step import STEPS

SCENARIOS = ROOT / "scenarios"
LENGTH = 60  # characters that show enough; the example nearest to it is taken
EXPECTED = ("expect", "until")
"""Keys of expectations; lists below other keys hold steps."""

TEMPORAL = ("always", "eventually", "never", "until")


def example(word: str, *, is_step: bool) -> str:
    """The example of a step or an expectation, after a link to the scenario that it is a part of.

    Raises:
        KeyError: No bundled scenario has the word.
    """
    uses = _found()[word, is_step]
    unlike = ("expect_error", "blend_radius")  # a step that fails, or one that stands in `sequence`
    file, text = min(
        uses, key=lambda use: (any(key in use[1] for key in unlike), abs(len(use[1]) - LENGTH))
    )
    if not is_step:
        text = "expect:\n" + indent(text, "  ")
    name = file.relative_to(SCENARIOS).as_posix().partition(".")[0]
    link = f"[`{name}`](../../{file.relative_to(ROOT).as_posix()})"
    return f"As in {link}:\n\n```yaml\n{text}\n```"


@cache
def _found() -> dict[tuple[str, bool], list[tuple[Path, str]]]:
    """Every use in the bundled scenarios, by its word and whether that is a step."""
    found: dict[tuple[str, bool], list[tuple[Path, str]]] = {}
    for file in sorted(SCENARIOS.rglob("*.*.yaml")):
        text = file.read_text(encoding="utf-8")
        for word, is_step, item in _uses(yaml.compose(text), is_step=True):
            found.setdefault((word, is_step), []).append((file, _quoted(text, item)))
    return found


def _uses(node: yaml.Node | None, *, is_step: bool) -> Iterator[tuple[str, bool, yaml.Node]]:
    """Words below a node, and the items of lists in which they stand."""
    if isinstance(node, yaml.SequenceNode):
        for item in node.value:
            words = STEPS if is_step else PREDICATES
            yield from ((word, is_step, item) for word in _names(item, deep=not is_step) & {*words})
            yield from _uses(item, is_step=is_step)
    elif isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            yield from _uses(value, is_step=is_step and key.value not in EXPECTED)


def _names(node: yaml.Node, *, deep: bool) -> set[str]:
    """The keys of an item; of an expectation also the predicates that temporal words hold."""
    if isinstance(node, yaml.ScalarNode):
        return {node.value}
    if not isinstance(node, yaml.MappingNode):
        return set()
    inside = (_names(value, deep=False) for key, value in node.value if key.value in TEMPORAL)
    return {key.value for key, _ in node.value}.union(*(inside if deep else ()))


def _quoted(text: str, node: yaml.Node) -> str:
    """An item of a list as it is written, at the left margin."""
    first, *others = text[node.start_mark.index : node.end_mark.index].rstrip().splitlines()
    lines = [f"- {first}", *(f"  {line[node.start_mark.column :]}" for line in others)]
    while lines[-1].strip().startswith("#"):
        lines.pop()
    return "\n".join(lines)
