"""Definitions of macros in xacro files."""

from __future__ import annotations

import re
from dataclasses import dataclass

from harness.language.files.xml_file import XmlElement

PARAMETER = re.compile(
    r"\s*(?P<name>[^\s:=]+?)\s*:?=\s*(?P<forward>\^\|?)?"
    r"(?P<default>\$\{.*?\}|\$\(.*?\)|(?:'[^']*+'|\"[^\"]*+\"|[^\s'\"]++)++|)(?:\s+|$)"
)
LONGEST = 10_000  # characters of all parameters
BARE = re.compile(r"\s*(?P<name>\S+)\s*")


@dataclass(frozen=True)
class Parameter:
    """A parameter of a macro.

    Attributes:
        name: Its name; of a block with `*` for the element, `**` for what is in it.
        default: The text of its default.
        is_forwarded: Whether it defaults to the caller's property of its name.
    """

    name: str
    default: str | None = None
    is_forwarded: bool = False

    @property
    def is_block(self) -> bool:
        """Whether an element in the call gives it, and not an attribute."""
        return self.name.startswith("*")


@dataclass(frozen=True)
class Macro:
    """A macro.

    Attributes:
        body: The element with its content.
    """

    name: str
    parameters: tuple[Parameter, ...]
    body: XmlElement


def read_macro(item: XmlElement) -> Macro:
    """The macro of an `<xacro:macro>`.

    Raises:
        SpecError: It has no name that a macro may have.
    """
    name = item.need("name").removeprefix("xacro:")
    if name == "call" or "." in name:
        item.refuse(f"a macro cannot be called '{name}'", at="name")
    parameters: list[Parameter] = []
    text = item.get("params")
    if len(text) > LONGEST:
        item.refuse(f"the parameters have more than {LONGEST} characters", at="params")
    position = 0
    while text[position:].strip():
        found = PARAMETER.match(text, position)
        if found:
            default = found["default"] or None
            parameters.append(Parameter(found["name"], default, bool(found["forward"])))
        else:
            found = BARE.match(text, position)
            assert found is not None
            parameters.append(Parameter(found["name"]))
        position = found.end()
    return Macro(name, tuple(parameters), item)
