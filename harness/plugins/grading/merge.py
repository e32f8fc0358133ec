"""A student's scenario with the world, the robot and the expectations of the assignment."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator
from pathlib import Path

from pydantic import BaseModel

from harness.cell.step import Step
from harness.core.errors import SpecError
from harness.language.files.source import Located, Place, Source
from harness.language.files.yaml_file import parse_yaml, read_text
from harness.language.reading.load import Reading, load_scenario

CHANGES_SCENE = frozenset(
    {"allow_collisions", "attach_object", "detach_object", "external", "include", "inject"}
)
"""Verbs that change what is judged, in addition to those that let objects appear or jump."""


def merged_source(
    submission: Path, scenario: Path, takes: Collection[str], name: str = ""
) -> Source:
    """The text of a scenario that has some keys of a submission, and all else of the assignment.

    The lines of the submission keep their numbers, so that steps and mistakes in it are reported
    where the student wrote them; the lines of other keys are empty. The assignment's lines follow,
    and count as those of its file. Parameters of both files are known; of those that both have,
    the assignment's count.

    Args:
        submission: The scenario file of a student.
        scenario: The scenario file of the assignment.
        takes: The keys that are the student's.
        name: What reports call the submission; its path by default.

    Raises:
        SpecError: The submission is not YAML, or has no `steps`.
    """
    name = name or str(submission)
    (own, given), (root, graded) = _blocks(submission, name), _blocks(scenario, scenario.name)
    if "steps" in takes and "steps" not in given:
        place = Place(Source.of_text(name, read_text(submission)), 1, 1)
        raise SpecError([place.problem("the scenario has no `steps`", "add `steps:`")])
    lines = [
        line if key in takes or not key else "" for key, block in given.items() for _, line in block
    ]
    further: list[tuple[int, str]] = []
    for key, block in graded.items():
        is_replaced = (key in takes and key in given) or key in ("", "params")
        further += [] if is_replaced else block
    params = {**_params(own), **_params(root)}
    further += [(0, f"params: {json.dumps(params)}")] if params else []
    others = tuple((scenario.name, number) for number, _ in further)
    return Source(name, (*lines, *(line for _, line in further)), others)


def scene_verbs(given: BaseModel, graded: BaseModel) -> list[str]:
    """Verbs of a student's steps that change the scene, and that the assignment does not have."""
    known = {step.verb for step in steps_in(graded)}
    changing = (s for s in steps_in(given) if s.moves_objects or s.verb in CHANGES_SCENE)
    return sorted({step.verb for step in changing} - known)


def refuse_scene_verbs(reading: Reading, scenario: Path) -> None:
    """Refuse steps of a student that change the scene where the assignment has none of the kind.

    Args:
        reading: The result of reading the merged text.
        scenario: The scenario file of the assignment.

    Raises:
        SpecError: It names the first of them, with its line.
    """
    if reading.loaded is None:
        return
    verbs = scene_verbs(reading.loaded.scenario, load_scenario(scenario).scenario)
    if verbs:
        message = f"the step `{verbs[0]}` changes the scene, which this exercise does not do"
        steps = enumerate(reading.loaded.scenario.steps)
        named = (i for i, step in steps if verbs[0] in {each.verb for each in steps_in(step)})
        place = ("steps", next(named, 0))
        raise SpecError([reading.loaded.lines.problem(place, message, "leave the step out")])


def steps_in(value: object) -> Iterator[Step]:
    """The steps in a model, at any depth."""
    if isinstance(value, Step):
        yield value
    if isinstance(value, BaseModel):
        for name in type(value).model_fields:
            yield from steps_in(getattr(value, name))
    elif isinstance(value, tuple | list):
        for each in value:  # pyright: ignore[reportUnknownVariableType]
            yield from steps_in(each)  # pyright: ignore[reportUnknownArgumentType]


def _params(root: Located) -> dict[str, object]:
    entry = root.mapping().get("params")
    plain = entry.value.plain() if entry is not None else {}
    return {**plain} if isinstance(plain, dict) else {}


def _blocks(file: Path, name: str) -> tuple[Located, dict[str, list[tuple[int, str]]]]:
    """A file, and the numbered lines of each key; those before the first under an empty name.

    Raises:
        SpecError: The file is not YAML, not a mapping, or has two keys in one line.
    """
    text = read_text(file)
    source = Source.of_text(name, text)
    root = parse_yaml(text, source)
    places = {key: each.key for key, each in root.mapping().items()}
    lines, starts = [*enumerate(source.lines, 1)], [place.line - 1 for place in places.values()]
    if not starts or len({*starts}) < len(starts):
        message = "a scenario has each of its keys in a line of its own"
        raise SpecError([root.place.problem(message)])
    ends = [*starts[1:], len(lines)]
    blocks = {"": lines[: starts[0]]}
    for key, start, end in zip(places, starts, ends, strict=True):
        blocks[key] = lines[start:end]
    return root, blocks
