"""Completion and hover texts of the editor, from the JSON Schema of scenario files."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from harness.language.schema import scenario_schema

Schema = Mapping[str, Any]
Path = tuple[str, ...]

ITEM = "-"
"""In a path: an item of a list."""

_KEY = re.compile(r"""^(\s*)((?:- +)*)(?:(["']?)([\w.-]+)\3\s*:(?:\s|$))?""")
_FLOW_KEY = re.compile(r"""([\w.-]+)["']?\s*:\s*$""")
_WORD = re.compile(r"[\w./-]*$")


@dataclass(frozen=True)
class Option:
    """A completion.

    Attributes:
        text: The text that is inserted.
        kind: The kind of the text: `key` or `value`.
        help: The description of the key.
    """

    text: str
    kind: str
    help: str


@dataclass(frozen=True)
class Names:
    """Names that exist in a cell, by what they name."""

    states: Sequence[str] = ()
    gripper_states: Sequence[str] = ()
    joints: Sequence[str] = ()
    links: Sequence[str] = ()
    objects: Sequence[str] = ()
    groups: Sequence[str] = ()
    worlds: Sequence[str] = ()
    robots: Sequence[str] = ()
    grippers: Sequence[str] = ()

    def of(self, path: Path) -> Sequence[str]:
        """Names that may stand at a path."""
        keys = [key for key in path if key != ITEM]
        last = keys[-1] if keys else ""
        bodies = (*self.objects, *self.links)
        kinds: dict[str, Sequence[str]] = {
            "move_to": self.states,
            "ptp": self.states,
            "named_target": (*self.states, *self.gripper_states),
            "gripper": self.grippers if "robot" in keys else self.gripper_states,
            "joints": self.joints,
            "positions": self.joints,
            "frame": ("world", *self.objects, *self.links),
            "link": self.links,
            "tcp_link": self.links,
            "object": self.objects,
            "on": bodies,
            "support": bodies,
            "between": ("robot", "gripper", "any", *bodies),
            "grasped": self.objects,
            "released": self.objects,
            "lifted": self.objects,
            "placed": self.objects,
            "upright": self.objects,
            "pick": self.objects,
            "place": self.objects,
            "grasp": self.objects,
            "release": self.objects,
            "group": self.groups,
            "world": self.worlds,
            "robot": self.robots,
            "model": self.robots,
        }
        return kinds.get(last, ())


@cache
def _schema() -> Schema:
    return scenario_schema()


def path_at(text: str, line: int, column: int) -> tuple[Path, bool]:
    """The keys and list items around a place, and whether a value (not a key) stands there.

    Works on text that is not yet YAML: indentation, dashes and brackets decide.

    Args:
        text: The text of the scenario.
        line: The line from 0.
        column: The column from 0.
    """
    lines = text.split("\n")
    current = lines[line] if line < len(lines) else ""
    before = _WORD.sub("", current[:column])
    head = _KEY.match(before)
    assert head is not None
    path = _outer(lines[:line], len(head[1]), is_item=bool(head[2]))
    path = (*path, *(ITEM for _ in re.findall("- +", head[2])))
    inner, is_value = _inside_brackets(before[head.end() :])
    if head[4]:
        return (*path, head[4], *inner), is_value
    return (*path, *inner), bool(inner) and is_value


def _outer(lines: Sequence[str], limit: int, *, is_item: bool) -> Path:
    """The path of the block that a line belongs to, by the columns of keys and dashes before it.

    Args:
        lines: The lines before it.
        limit: The column where the line begins.
        is_item: Whether it begins with a dash, which may stand right below its key.
    """
    found: list[str] = []
    for line in reversed(lines):
        match = _KEY.match(line)
        if match is None or not line.strip() or line.lstrip().startswith("#"):
            continue
        openers = [(each.start(), ITEM) for each in re.finditer("- +", line[: match.end(2)])]
        if match[4]:
            openers.append((match.end(2), match[4]))
        for column, name in reversed(openers):
            if column < limit or (column == limit and is_item and name != ITEM):
                found.append(name)
                limit, is_item = column, name == ITEM
    return tuple(reversed(found))


def _inside_brackets(text: str) -> tuple[Path, bool]:
    """The path that a line's open brackets add, and whether a value stands at its end."""
    stack: list[tuple[str, str]] = []
    key = ""
    for index, character in enumerate(text):
        if character in "{[":
            stack.append((character, key))
            key = ""
        elif character in "}]":
            if stack:
                stack.pop()
            key = ""
        elif character == ",":
            key = ""
        elif character == ":":
            match = _FLOW_KEY.search(text[: index + 1])
            key = match[1] if match else ""
    path: list[str] = []
    for bracket, name in stack:
        if name:
            path.append(name)
        if bracket == "[":
            path.append(ITEM)
    is_value = not stack or stack[-1][0] == "[" or bool(key)
    return (*path, key) if key else tuple(path), is_value


def complete(text: str, line: int, column: int, names: Names) -> list[Option]:
    """What may be written at a place, keys with their descriptions."""
    path, is_value = path_at(text, line, column)
    options: list[Option] = []
    for node in _nodes(path):
        if not is_value:
            for key, child in node.get("properties", {}).items():
                options.append(Option(key, "key", _first_line(_description(child))))
        words = [*node.get("enum", ()), *((node["const"],) if "const" in node else ())]
        words += ("true", "false") if node.get("type") == "boolean" else ()
        options += [Option(str(word), "value", "") for word in words]
    kind = "value" if is_value else "key"
    options += [Option(name, kind, "") for name in names.of(path)]
    return list({option.text: option for option in options}.values())


def hover(text: str, line: int, column: int) -> str:
    """The description of the key under a place; empty where there is none."""
    lines = text.split("\n")
    if line >= len(lines):
        return ""
    current = lines[line]
    start = len(_WORD.sub("", current[:column]))
    rest = re.match(r"[\w.-]+", current[start:])
    if rest is None:
        return ""
    path, _ = path_at(text, line, start)
    word = rest[0]
    for node in _nodes(path):
        child = node.get("properties", {}).get(word)
        if child is not None:
            return _description(child)
    return ""


def _nodes(path: Path) -> Iterator[Schema]:
    """Every schema that may hold at a path, references and alternatives followed."""
    nodes = list(_alternatives(_schema()))
    for key in path:
        following: list[Schema] = []
        for node in nodes:
            if key == ITEM:
                child = node.get("items")
            else:
                child = node.get("properties", {}).get(key)
                more = node.get("additionalProperties")
                child = more if child is None and isinstance(more, dict) else child
            if isinstance(child, dict):
                following += _alternatives(child)
        nodes = following
    yield from nodes


def _alternatives(node: Schema) -> Iterator[Schema]:
    if "$ref" in node:
        yield from _alternatives(_schema()["$defs"][node["$ref"].rpartition("/")[2]])
        return
    for word in ("anyOf", "allOf", "oneOf"):
        for each in node.get(word, ()):
            yield from _alternatives(each)
    if not {"anyOf", "allOf", "oneOf"} & set(node) or {"properties", "items"} & set(node):
        yield node


def _description(node: Schema) -> str:
    if "description" in node:
        return str(node["description"])
    for each in (*node.get("anyOf", ()), *node.get("allOf", ())):
        found = _description(each)
        if found:
            return found
    if "$ref" in node:
        return _description(_schema()["$defs"][node["$ref"].rpartition("/")[2]])
    return ""


def _first_line(text: str) -> str:
    return text.partition("\n\n")[0]
