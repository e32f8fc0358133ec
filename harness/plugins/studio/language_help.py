"""Completion and hover texts of the editor, from the JSON Schema of scenario files."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import yaml

from harness.core.registry import registry
from harness.language.language import EXPECTATIONS
from harness.language.step import STEPS

Schema = Mapping[str, Any]
Path = tuple[str, ...]

ITEM = "-"  # in a path: an item of a list
MARK = "\ue000"  # a character of no script, put where the cursor is

_OTHER_BREAKS = re.compile("[\r\x85\u2028\u2029]")  # lines of YAML, not of the page
_WORD = re.compile(r"[\w./-]*$")


@dataclass(frozen=True)
class Option:
    """A completion.

    Attributes:
        kind: The kind of the text: `key` or `value`.
        help: The description of the key.
    """

    text: str
    kind: str
    help: str


Names = Mapping[str, Sequence[str]]
"""Names that exist in a cell, by the fields that take them: `object`, `link`, `joints`."""

GRIPPER_TARGET = "gripper_target"  # in names: the `named_target` of a step that moves the gripper


def named_at(path: Path, names: Names) -> Sequence[str]:
    """Names that may stand at a path."""
    keys = [key for key in path if key != ITEM]
    field = keys[-1] if keys else ""
    if "robot" in keys:
        return names.get(field, ())
    steps = [STEPS[key] for key in keys if key in STEPS]
    if field in STEPS:  # a bare value stands for one of its fields
        field = steps[-1].short
    elif field in EXPECTATIONS and field not in names:
        field = EXPECTATIONS[field].short
    if field == "named_target" and steps and steps[-1].moves_gripper:
        field = GRIPPER_TARGET
    return names.get(field, ())


@cache
def _schema() -> Schema:
    return json.loads(registry("command").find("schema")().text())


def path_at(text: str, line: int, column: int) -> tuple[Path, bool]:
    """The keys and list items around a place, and whether a value (not a key) stands there.

    Only what stands before the place is read, and of that not the lines with mistakes.

    Args:
        line: The line from 0.
        column: The column from 0.

    Raises:
        ValueError: The line is not YAML, or the place is in a comment.
    """
    lines = _OTHER_BREAKS.sub(" ", text).split("\n")[: line + 1]
    lines[-1] = _WORD.sub("", lines[-1][:column])
    for _ in lines:  # each time without one that has a mistake
        broken = line
        for end in (":", ""):  # a key, else a value
            try:
                return _path_to_mark("\n".join(lines) + MARK + end)
            except yaml.MarkedYAMLError as error:
                broken = error.problem_mark.line if error.problem_mark else line
            except yaml.YAMLError as error:  # of characters, which have no mark
                raise ValueError("the text has characters that YAML does not know") from error
        if broken >= line:
            break
        lines[broken] = ""
    raise ValueError("this line is not YAML")


def _path_to_mark(text: str) -> tuple[Path, bool]:
    around: list[str] = []  # of each open collection: ITEM, the key whose value follows, or ""
    for event in yaml.parse(text):
        match event:
            case yaml.MappingStartEvent(flow_style=True) if text[event.start_mark.index] == MARK:
                continue  # an item of a list in brackets
            case yaml.CollectionStartEvent():
                around.append("" if isinstance(event, yaml.MappingStartEvent) else ITEM)
                continue
            case yaml.ScalarEvent(value=str(word)) if MARK in word:
                return tuple(filter(None, around)), bool(around and around[-1])
            case yaml.ScalarEvent(value=str(key)) if around and not around[-1]:
                around[-1] = key
                continue
            case yaml.CollectionEndEvent():
                around.pop()
            case _:
                pass
        if around and around[-1] != ITEM:
            around[-1] = ""
    raise ValueError("the place is in a comment")


def complete(text: str, line: int, column: int, names: Names) -> list[Option]:
    """What may be written at a place, keys with their descriptions."""
    try:
        path, is_value = path_at(text, line, column)
    except ValueError:
        return []
    options: list[Option] = []
    for node in _nodes(path):
        if not is_value:
            for key, child in node.get("properties", {}).items():
                options.append(Option(key, "key", _description(child).partition("\n\n")[0]))
        words = [*node.get("enum", ()), *((node["const"],) if "const" in node else ())]
        words += ("true", "false") if node.get("type") == "boolean" else ()
        options += [Option(str(word), "value", "") for word in words]
    if is_value or not options:
        kind = "value" if is_value else "key"
        options += [Option(name, kind, "") for name in named_at(path, names)]
    return list({option.text: option for option in options}.values())


def hover(text: str, line: int, column: int) -> str:
    """The description of the key under a place; empty where there is none."""
    lines = text.split("\n")
    current = lines[line] if line < len(lines) else ""
    start = len(_WORD.sub("", current[:column]))
    word = re.match(r"[\w.-]+", current[start:])
    if word is None:
        return ""
    try:
        path, _ = path_at(text, line, start)
    except ValueError:
        return ""
    found = (node.get("properties", {}).get(word[0]) for node in _nodes(path))
    return next((_description(each) for each in found if each is not None), "")


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
