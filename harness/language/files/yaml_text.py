"""Writes values as YAML that a person likes to read and that loads to the same values."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Any

import yaml

from harness.language.files.source import Located
from harness.language.files.yaml_scalars import is_plain_text

LONGEST_FLOW = 88  # characters of a list or mapping that stands on one line

TEXT = "tag:yaml.org,2002:str"
NOT_TEXT = "plain"
UNTYPED: Any = yaml


def yaml_text(root: Located, *, block_keys: Collection[str] = ()) -> str:
    """A mapping as YAML text: one line for what is short, else a line for each item.

    Args:
        block_keys: Keys whose lists always have a line for each item.
    """
    node = _Nodes(block_keys).node(root)
    node.flow_style = False
    options = {"Dumper": _Writer, "allow_unicode": True, "width": math.inf}
    return str(UNTYPED.serialize(node, **options))


class _Writer(yaml.SafeDumper):
    """Leaves out the quotes of a text only where YAML 1.1 and 1.2 both read it as text."""

    def resolve(self, kind: Any, value: Any, implicit: Any) -> str:
        resolver: Any = super()
        detected = str(resolver.resolve(kind, value, implicit))
        if kind is not yaml.ScalarNode or not implicit[0]:
            return detected
        return TEXT if detected == TEXT and is_plain_text(value) else NOT_TEXT

    def increase_indent(self, flow: bool = False, indentless: bool = False) -> None:  # noqa: ARG002
        emitter: Any = super()
        emitter.increase_indent(flow, False)  # lists stand further right than their key


class _Nodes:
    def __init__(self, block_keys: Collection[str]) -> None:
        self.block_keys = block_keys

    def node(self, item: Located, key: str = "") -> Any:
        value = item.value
        if isinstance(value, dict):
            pairs = [(_text(name), self.node(entry.value, name)) for name, entry in value.items()]
            is_flow = _is_short(item) and not any(_is_block(node) for _, node in pairs)
            return UNTYPED.MappingNode("tag:yaml.org,2002:map", pairs, flow_style=is_flow)
        if isinstance(value, list):
            nodes = [self.node(child) for child in value]
            is_block = key in self.block_keys and bool(nodes)
            for node in nodes if is_block else ():
                if isinstance(node, yaml.MappingNode):
                    node.flow_style = False
            is_flow = _is_short(item) and not is_block and not any(map(_is_block, nodes))
            return UNTYPED.SequenceNode("tag:yaml.org,2002:seq", nodes, flow_style=is_flow)
        if isinstance(value, str):
            return _text(value)
        if value is None or isinstance(value, bool):
            return UNTYPED.ScalarNode(NOT_TEXT, "null" if value is None else str(value).lower())
        return UNTYPED.ScalarNode(NOT_TEXT, repr(value))


def _text(value: str) -> Any:
    """Text on one line; line breaks and the like are escaped."""
    return UNTYPED.ScalarNode(TEXT, value, style=None if value.isprintable() else '"')


def _is_block(node: Any) -> bool:
    return isinstance(node, yaml.CollectionNode) and not node.flow_style


def _is_short(item: Located) -> bool:
    return len(str(item.plain())) <= LONGEST_FLOW
