"""A first scenario for a robot: a pick where it has a gripper and a place for it, else a motion."""

from __future__ import annotations

import json
import os
import re
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from string import Template

from harness.plugins.authoring.scenario_candidates import Candidates
from harness.robot.description import RobotDescription
from harness.robot.robot_source import RobotSource, load_source
from harness.session.check import check_file
from harness.session.run_case import run_case
from harness.session.run_request import RunRequest

TEMPLATES = Path(__file__).parent / "templates"
MOST_RUNS = 3  # Scenarios of a kind that are run; each takes seconds
PICK_SECONDS = 40.0  # wall time after which no other pick is tried: a motion within a minute


@dataclass(frozen=True)
class FirstScenario:
    """A scenario that was checked and run.

    Attributes:
        text: The text of the file.
        trouble: Why it does not pass; empty when it passes.
        no_pick: Why it is a motion and no pick; empty for a pick.
    """

    text: str
    trouble: str = ""
    no_pick: str = ""


def first_scenario(
    source: RobotSource, file: Path, progress: Callable[[str], None] = lambda _: None
) -> FirstScenario:
    """A scenario that passes, if one can be found.

    Args:
        source: The source of the robot.
        file: Where it will be: robots' files are named from its folder, and candidates are
            written next to it and removed again.
        progress: Called with a text whenever another candidate is tried.

    Raises:
        SpecError: A file of the robot has mistakes.
        RobotError: The robot is not known, or its files cannot be used.
    """
    end = time.monotonic() + PICK_SECONDS
    description = load_source(source)
    candidates = Candidates(description)
    words = {
        "name": description.name,
        "title": _text(f"First steps of {description.name}"),
        "robot": _robot_words(source, file.parent) + candidates.start_state(),
    }
    no_pick = _why_no_gripper(description)
    trouble = text = ""
    for template, numbers in (("pick", candidates.picks()), ("move", candidates.motions())):
        tried = runs = 0
        for each in numbers:
            text = _filled(template, {**words, **each})
            tried += 1
            progress(f"  trying {'a pick' if template == 'pick' else 'a motion'}, number {tried}")
            trouble, has_run = _trouble(text, file.with_name(f".{file.name}"))
            if not trouble:
                return FirstScenario(text, no_pick="" if template == "pick" else no_pick)
            runs += has_run
            if runs == MOST_RUNS or (template == "pick" and time.monotonic() > end):
                break
        if template == "pick" and tried:
            no_pick = f"none of {tried} picks passes; the last: {trouble}"
    return FirstScenario(text, trouble, no_pick)


def _trouble(text: str, candidate: Path) -> tuple[str, bool]:
    """Why a scenario does not pass, empty when it does; and whether it was run."""
    try:
        candidate.write_text(text, encoding="utf-8")
        found = check_file(candidate)
        if found.problems or found.predicted:
            return (found.problems or found.predicted)[0].message, False
        result = run_case(RunRequest(candidate, stills=False))
    finally:
        candidate.unlink(missing_ok=True)
    if result.outcome == "passed":
        return "", True
    failed = [step.message for step in result.steps if step.message]
    wrong = [each for each in result.verdicts if each.status != "passed"]
    judged = [f"{each.expectation}: {each.reason}" for each in wrong]
    return (failed[-1:] or [*judged, result.message])[0], True


def _why_no_gripper(description: RobotDescription) -> str:
    if description.gripper is not None:
        return ""
    return (
        description.rejected_grippers
        or ["no joint that the arm carries closes two sides of a gripper"]
    )[0]


def _filled(template: str, words: Mapping[str, str]) -> str:
    text = (TEMPLATES / f"{template}.scenario.yaml").read_text(encoding="utf-8")
    return Template(text).substitute(words)


def _robot_words(source: RobotSource, folder: Path) -> str:
    """The scenario's `robot:`."""

    def named(file: str) -> str:
        is_file = not file.startswith("package://") and Path(file).exists()
        return _text(Path(os.path.relpath(file, folder)).as_posix() if is_file else file)

    lines = ["robot:"]
    for key, value in source.words().items():
        match value:
            case dict():
                inner = ", ".join(f"{name}: {_text(str(item))}" for name, item in value.items())
                lines.append(f"  {key}: {{{inner}}}")
            case tuple():
                lines.append(f"  {key}: [{', '.join(named(each) for each in value)}]")
            case _:
                lines.append(f"  {key}: {named(value)}")
    return "\n".join(lines)


def _text(value: str) -> str:
    """A text as YAML, in quotes where it needs them."""
    return value if re.fullmatch(r"[A-Za-z./~][\w ./:+()-]*", value) else json.dumps(value)
