"""A student's scenario with the world, the robot and the expectations of the assignment."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

from harness.core.errors import SpecError
from harness.language.files.source import Place, Source
from harness.language.files.yaml_file import parse_yaml, read_text


def merged_text(submission: Path, scenario: Path, takes: Collection[str]) -> str:
    """The text of a scenario that has some keys of a submission, and all else of the assignment.

    The lines of the submission keep their numbers, so that mistakes in it are reported where the
    student wrote them; the lines of other keys are empty, and the assignment's follow at the end.

    Args:
        submission: The scenario file of a student.
        scenario: The scenario file of the assignment.
        takes: The keys that are the student's.

    Raises:
        SpecError: The submission is not YAML, or has no `steps`.
    """
    given, graded = _blocks(submission), _blocks(scenario)
    if "steps" in takes and "steps" not in given:
        place = Place(Source.of_text(str(submission), read_text(submission)), 1, 1)
        raise SpecError([place.problem("the scenario has no `steps`", "add `steps:`")])
    lines: list[str] = []
    for key, block in given.items():
        lines += block if key in takes or not key else [""] * len(block)
    for key, block in graded.items():
        lines += [] if (key in takes and key in given) or not key else block
    return "\n".join(lines) + "\n"


def _blocks(file: Path) -> dict[str, list[str]]:
    """The lines of each key of a file, in order; those before the first key under an empty name.

    Raises:
        SpecError: The file is not YAML, not a mapping, or has two keys in one line.
    """
    text = read_text(file)
    source = Source.of_text(str(file), text)
    root = parse_yaml(text, source)
    places = {key: each.key for key, each in root.mapping().items()}
    lines, starts = [*source.lines], [place.line - 1 for place in places.values()]
    if not starts or len({*starts}) < len(starts):
        message = "a scenario has each of its keys in a line of its own"
        raise SpecError([root.place.problem(message)])
    ends = [*starts[1:], len(lines)]
    blocks = {"": lines[: starts[0]]}
    for key, start, end in zip(places, starts, ends, strict=True):
        blocks[key] = lines[start:end]
    return blocks
