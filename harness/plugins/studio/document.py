"""The scenario as text: steps and objects are added to it without changing what is written."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

import yaml

from harness.core.errors import SpecError
from harness.language.files.source import Located, Source
from harness.language.files.yaml_file import parse_yaml

INDENT = "  "
ROBOT_BLOCK = re.compile(r"^robots?:.*(?:\n[ \t#].*|\n(?=[ \t\n#]))*", re.MULTILINE)
STAND_IN = "wait: 1 ms"  # the step that a scenario without steps is compiled with

Plain = Any


def new_text(title: str, robot: Mapping[str, Plain], world: str) -> str:
    """The text of a scenario that has a robot and a world, and no steps yet."""
    spec: Plain = robot["model"] if set(robot) == {"model"} else dict(robot)
    return (
        f"scenario: {flow(title)}\n"
        f"robot: {flow(spec)}\n"
        f"world: {flow(world)}\n"
        "planning: {max_velocity_scaling_factor: 0.3, max_acceleration_scaling_factor: 0.3}\n"
        "steps: []\n"
    )


def robot_alone(text: str) -> str:
    """The text of a scenario with the robot of a text that has mistakes elsewhere, and no more.

    The text need not be YAML: its robot is the block of lines that begins with `robot:`.
    """
    block = ROBOT_BLOCK.search(text)
    robot = block[0].rstrip() if block else "robot:"
    return f"scenario: the robot alone\n{robot}\nsteps: []\n"


def flow(value: Plain) -> str:
    """A value on one line, as a person would write it; numbers keep at most six decimals."""
    text = yaml.safe_dump(
        _rounded(value), default_flow_style=True, width=10**6, sort_keys=False, allow_unicode=True
    ).strip()
    # the writer quotes the words that were booleans in YAML 1.1
    return re.sub(r"'(on|off|yes|no|y|n)':", r"\1:", text.removesuffix("...").strip())


def _rounded(value: Plain) -> Plain:
    if isinstance(value, float):
        rounded = round(value, 6) + 0.0
        return int(rounded) if rounded == int(rounded) and abs(rounded) < 1e6 else rounded
    if isinstance(value, Mapping):
        return {str(key): _rounded(item) for key, item in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, str):
        return [_rounded(item) for item in value]
    return value


class Document:
    """A scenario's text, with the places of its steps and objects."""

    def __init__(self, text: str, name: str = "scenario") -> None:
        """Read a text; messages call it by the name.

        Raises:
            SpecError: It is not YAML, or not a mapping.
        """
        self.text, self.name = text, name
        self.lines = text.splitlines()
        self.root: Located = parse_yaml(text, Source.of_text(name, text), [])

    @property
    def step_count(self) -> int:
        """Number of steps at the top level of the file."""
        return len(self._items("steps"))

    def compiled_text(self) -> str:
        """The text that is compiled: without any step, the one with a step that does nothing."""
        if self.step_count or "steps" not in self.root.mapping():
            return self.text
        return self.with_step(STAND_IN, 0).text

    def step_lines(self) -> list[int]:
        """The first line of each step, from 1."""
        return [self._first_line("steps", index) for index in range(self.step_count)]

    def step_at(self, line: int) -> int:
        """The index of the step in which a line is; -1 before the first step."""
        return sum(first <= line for first in self.step_lines()) - 1

    def step_keys(self) -> list[str]:
        """Text by which equal steps are recognised, one for each step at the top level."""
        plain = self._plain
        shared = {key: plain.get(key) for key in ("seed", "planning", "params")}
        return [
            json.dumps([index, _executed(step), shared], sort_keys=True, default=str)
            for index, step in enumerate(plain.get("steps") or ())
        ]

    def base_key(self) -> str:
        """Text that changes when the cell has to be built again, for other reasons than steps."""
        plain = self._plain
        keys = ("robot", "robots", "world", "objects", "cameras", "params")
        return json.dumps([plain.get(key) for key in keys], sort_keys=True, default=str)

    @property
    def _plain(self) -> dict[str, Plain]:
        plain = self.root.plain()
        assert isinstance(plain, dict)
        return plain

    def with_step(self, step: str, index: int) -> Document:
        """The document with one more step, given as `verb: keys` on one line or several."""
        return self._with_item("steps", step, index)

    def without_step(self, index: int) -> Document:
        """The document without one of its steps."""
        first, last = self._extent("steps", index)
        lines = self.lines[: first - 1] + self.lines[last:]
        if self.step_count == 1:
            lines[self.root.mapping()["steps"].key.line - 1] = "steps: []"
        return self._with(lines)

    def with_object(self, spec: Mapping[str, Plain]) -> Document:
        """The document with an object; one of the same name in `objects` is replaced."""
        names = self.object_names()
        if spec["name"] in names:
            return self.without_object(str(spec["name"])).with_object(spec)
        return self._with_item("objects", flow(dict(spec)), len(names))

    def without_object(self, name: str) -> Document:
        """The document without one of its own objects; `objects` goes with the last one."""
        names = self.object_names()
        first, last = self._extent("objects", names.index(name))
        if len(names) == 1:
            first = self.root.mapping()["objects"].key.line
        return self._with(self.lines[: first - 1] + self.lines[last:])

    def object_names(self) -> list[str]:
        """Names of the objects in `objects`, in file order."""
        return [
            str(item.mapping()["name"].value.value)
            for item in self._items("objects")
            if "name" in item.mapping()
        ]

    def object_specs(self) -> list[dict[str, Plain]]:
        """The objects of `objects` as plain data."""
        plain = [item.plain() for item in self._items("objects")]
        return [dict(item) for item in plain if isinstance(item, dict)]

    def object_spec(self, name: str) -> dict[str, Plain]:
        """An object of `objects` as plain data."""
        return next(spec for spec in self.object_specs() if spec.get("name") == name)

    def with_world(self, name: str) -> Document:
        """The document with another world."""
        entry = self.root.mapping().get("world")
        line = f"world: {flow(name)}"
        if entry is None:
            keys = self.root.mapping()
            at = (keys.get("robot") or keys["robots"]).key.line - 1
            return self._with([*self.lines[:at], line, *self.lines[at:]])
        row = entry.key.line
        last = self._end_of_item(row, 0, len(self.lines))
        return self._with([*self.lines[: row - 1], line, *self.lines[last:]])

    def with_expectations(self, expectations: Sequence[str], step: int) -> Document:
        """The document with expectations of a step, or with -1 of the whole run."""
        if step < 0:
            document = self
            for text in expectations:
                count = len(document._items("expect"))
                document = document._with_item("expect", text, count)
            return document
        item = self._items("steps")[step]
        first, last = self._extent("steps", step)
        column = self.lines[first - 1].index("-") + 2
        given = item.mapping().get("expect")
        if item.mapping() and self.lines[first - 1][column : column + 1] in "{[":
            raise SpecError([item.place.problem("write this step over several lines first")])
        margin = " " * column
        if given is None:
            added = [f"{margin}expect:", *(f"{margin}{INDENT}- {text}" for text in expectations)]
            return self._with([*self.lines[:last], *added, *self.lines[last:]])
        items = given.value.items()
        if not items or self.lines[given.key.line - 1].rstrip().endswith("]"):
            raise SpecError([given.key.problem("write `expect` as a list over several lines")])
        row = items[-1].place.line
        dash = " " * (len(self.lines[row - 1]) - len(self.lines[row - 1].lstrip()))
        end = self._end_of_item(row, len(dash), last)
        added = [f"{dash}- {text}" for text in expectations]
        return self._with([*self.lines[:end], *added, *self.lines[end:]])

    def _with(self, lines: Sequence[str]) -> Document:
        """The document with other lines."""
        return Document("\n".join(lines).rstrip("\n") + "\n", self.name)

    def _items(self, key: str) -> list[Located]:
        entry = self.root.mapping().get(key)
        return [] if entry is None else entry.value.items()

    def _first_line(self, key: str, index: int) -> int:
        """The line of an item's dash; a step's place is its first key."""
        item = self._items(key)[index]
        return min([item.place.line, *(entry.key.line for entry in item.mapping().values())])

    def _extent(self, key: str, index: int) -> tuple[int, int]:
        """First and last line of an item, from 1."""
        first = self._first_line(key, index)
        line = self.lines[first - 1]
        if not line.lstrip().startswith("- "):
            place = self._items(key)[index].place
            raise SpecError([place.problem(f"write `{key}` as a list over several lines first")])
        return first, self._end_of_item(first, len(line) - len(line.lstrip()), len(self.lines))

    def _end_of_item(self, first: int, indent: int, most: int) -> int:
        """The last line of what begins with a dash in a line, blank and comment lines left out."""
        last = first
        for number in range(first + 1, most + 1):
            line = self.lines[number - 1]
            stripped = line.strip()
            if stripped and len(line) - len(line.lstrip()) <= indent:
                if stripped.startswith("#"):
                    continue
                break
            if stripped and not stripped.startswith("#"):
                last = number
        return last

    def _with_item(self, key: str, item: str, index: int) -> Document:
        items = self._items(key)
        entry = self.root.mapping().get(key)
        if entry is None:
            return self._with_key(key, item)
        row = entry.key.line
        if not items:
            head = [*self.lines[: row - 1], f"{key}:"]
            return self._with([*head, *_item_lines(item, INDENT), *self.lines[row:]])
        dash = self.lines[self._first_line(key, 0) - 1]
        margin = dash[: len(dash) - len(dash.lstrip())]
        if index < len(items):
            at = self._extent(key, index)[0] - 1
        else:
            at = self._extent(key, len(items) - 1)[1]
        lines = [*self.lines[:at], *_item_lines(item, margin), *self.lines[at:]]
        return self._with(lines)

    def _with_key(self, key: str, item: str) -> Document:
        """The document with a new list at the top level: objects stand before the steps."""
        lines = [f"{key}:", *_item_lines(item, INDENT)]
        steps = self.root.mapping().get("steps")
        if key == "objects" and steps is not None:
            at = steps.key.line - 1
            return self._with([*self.lines[:at], *lines, *self.lines[at:]])
        return self._with([*self.lines, *lines])


def _item_lines(item: str, margin: str) -> list[str]:
    first, *rest = item.splitlines()
    return [f"{margin}- {first}", *(f"{margin}  {line}" for line in rest)]


def _executed(step: Plain) -> Plain:
    """What of a step decides its execution: expectations are judged afterwards."""
    return {k: v for k, v in step.items() if k != "expect"} if isinstance(step, dict) else step
