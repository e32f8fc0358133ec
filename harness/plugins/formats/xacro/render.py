"""Renders xacro files: properties, macros, conditions and includes are replaced by elements."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from harness.core.suggestion import did_you_mean
from harness.language.files.xml_file import XmlElement
from harness.plugins.formats.xacro.files import Files, MissingFile
from harness.plugins.formats.xacro.macro import Macro, Parameter, read_macro
from harness.plugins.formats.xacro.mixed_xml import LITERAL, TEXT, in_elements
from harness.plugins.formats.xacro.names import xacro_names
from harness.plugins.formats.xacro.substitution import Substitution
from harness.plugins.formats.xacro.symbols import Table, Text, is_property_name, truth
from harness.plugins.formats.xacro.values import Budget, Exhausted, ExpressionError
from harness.robot.packages import PackagePath
from harness.robot.xacro_file import OTHERS, PREFIX

STEPS_OF_ELEMENT = 20  # Steps that an element counts as

ENDLESS = "it takes more steps to render than any robot does"


@dataclass(frozen=True)
class Scope:
    """The properties and the macros that are known at some place."""

    symbols: Table
    macros: Table


def render(path: Path, args: Mapping[str, Any], packages: PackagePath) -> XmlElement:
    """The document of a xacro file, each element with the place in the file that it comes from.

    Args:
        path: The path of the file.
        args: The values of its arguments.
        packages: Search path for `$(find ...)`, and the folders that may be read.

    Raises:
        SpecError: The file, or one that it includes, cannot be rendered.
    """
    return _Rendering(args, packages).document(path)


def argument_text(value: object) -> str:
    """An argument's value as xacro files write it."""
    return str(value).lower() if isinstance(value, bool) else str(value)


class _Rendering:
    """One rendering: documents go in, the elements of one document come out."""

    def __init__(self, args: Mapping[str, Any], packages: PackagePath) -> None:
        self._budget = Budget()
        texts = {name: argument_text(value) for name, value in args.items()}
        self._texts = Substitution(texts, packages, self._budget)
        self._files = Files(packages, self._budget)
        self._names = xacro_names(self._texts, self._files, self._budget)
        self._at: XmlElement | None = None
        self._handlers: dict[str, Callable[[XmlElement, Scope, XmlElement], None]] = {
            "xacro:arg": self._arg,
            "xacro:attribute": self._attribute,
            "xacro:element": self._element,
            "xacro:if": self._condition,
            "xacro:include": self._include,
            "xacro:insert_block": self._insert_block,
            "xacro:macro": self._macro,
            "xacro:property": self._property,
            "xacro:unless": self._condition,
        }

    def document(self, path: Path) -> XmlElement:
        """The rendered document of a file."""
        source = self._at = self._files.document(path)
        scope = Scope(Table(self._names, self._evaluate), Table(None, self._evaluate))
        holder = XmlElement("", {}, source.place)
        try:
            self._plain(source, scope, holder)
        except Exhausted:
            self._at.refuse(ENDLESS, "look for a macro or expression without an end")
        except RecursionError:
            self._at.refuse(
                "a macro, property or include runs in a circle, or is nested too deeply"
            )
        root = in_elements(holder.children[0])
        self._refuse_missing_packages(root)
        return root

    def _refuse_missing_packages(self, root: XmlElement) -> None:
        """Refuse missing packages in what is read of a rendered robot."""
        for child in root.children if self._texts.missing else ():
            for item in child.walk() if child.tag not in OTHERS else ():
                for key, value in [*item.attributes.items(), ("", item.text)]:
                    if message := self._texts.missing_in(value):
                        item.refuse(message, at=key)

    # what a text means

    def _evaluate(self, text: Text, table: Table) -> Any:
        return self._texts.value(text.text, table, text.place)

    def _of(self, item: XmlElement, key: str, scope: Scope) -> Any:
        """The value of an attribute."""
        return self._texts.value(item.need(key), scope.symbols, item.place_of(key))

    def _truth(self, item: XmlElement, key: str, scope: Scope, default: str) -> bool:
        value = self._of(item, key, scope) if key in item.attributes else default
        found = truth(value)
        if found is None:
            item.refuse(f"'{value}' is not true or false", "write true, false, 1 or 0", at=key)
        return found

    # elements

    def _content(self, source: XmlElement, scope: Scope, target: XmlElement) -> None:
        """Render what is in an element into another."""
        for item in source.children:
            self._at = item
            self._budget.spend(1)
            if item.tag == LITERAL:
                target.children.append(item)
            elif item.tag == TEXT:
                text = self._texts.text(item.text, scope.symbols, item.place)
                target.children.append(XmlElement(TEXT, {}, item.place, text=text))
            elif not item.tag.startswith(PREFIX):
                self._plain(item, scope, target)
            else:
                self._handlers.get(item.tag, self._call)(item, scope, target)

    def _plain(self, source: XmlElement, scope: Scope, target: XmlElement) -> None:
        """Render an element that is not xacro's, with its attributes and content."""
        self._budget.spend(STEPS_OF_ELEMENT)
        item = XmlElement(source.tag, {}, source.place)
        for key, value in source.attributes.items():
            if not key.startswith(PREFIX) and key != "xmlns:xacro":
                place = source.place_of(key) if "$" in value else source.place
                item.attributes[key] = self._texts.text(value, scope.symbols, place)
        self._content(source, scope, item)
        target.children.append(item)

    def _inside(self, source: XmlElement, scope: Scope) -> XmlElement:
        """An element that holds the rendered content of another."""
        self._budget.spend(STEPS_OF_ELEMENT)
        holder = XmlElement("", {}, source.place)
        self._content(source, scope, holder)
        return holder

    def _arg(self, item: XmlElement, scope: Scope, _target: XmlElement) -> None:
        name, default = item.need("name"), item.need("default")
        if name not in self._texts.args:
            place = item.place_of("default")
            self._texts.args[name] = self._texts.text(default, scope.symbols, place)

    def _attribute(self, item: XmlElement, scope: Scope, target: XmlElement) -> None:
        name, value = self._of(item, "name", scope), self._of(item, "value", scope)
        if not isinstance(name, str) or not name:
            item.refuse("an attribute has a name", at="name")
        target.attributes[name] = self._texts.written(value, item.place_of("value"))

    def _element(self, item: XmlElement, scope: Scope, target: XmlElement) -> None:
        name = self._of(item, "xacro:name", scope)
        if not isinstance(name, str) or not name or name == item.tag:
            item.refuse("an element has a name", at="xacro:name")
        attributes = {key: value for key, value in item.attributes.items() if key != "xacro:name"}
        renamed = XmlElement(name, attributes, item.place, item.children)
        self._content(XmlElement("", {}, item.place, [renamed]), scope, target)

    def _condition(self, item: XmlElement, scope: Scope, target: XmlElement) -> None:
        item.need("value")
        if self._truth(item, "value", scope, "") == (item.tag == "xacro:if"):
            target.children += self._inside(item, scope).children

    def _property(self, item: XmlElement, scope: Scope, _target: XmlElement) -> None:
        table = scope.symbols
        name = self._of(item, "name", scope)
        if not is_property_name(name):
            item.refuse(f"'{name}' is not a name that a property may have", at="name")
        has_remove = self._truth(item, "remove", scope, "false")
        given = [key for key in ("value", "default") if key in item.attributes]
        if len(given) + has_remove > 1:
            item.refuse("a property has one of `value`, `default` and `remove`")
        if has_remove:
            table.remove(name)
        elif not given:
            self._target(item, table)[f"**{name}"] = item
        elif given == ["value"] or name not in table:
            value = Text(item.need(given[0]), item.place_of(given[0]))
            is_lazy = "scope" not in item.attributes and self._truth(
                item, "lazy_eval", scope, "true"
            )
            found = value if is_lazy or "$" not in value.text else self._evaluate(value, table)
            self._target(item, table)[name] = found

    def _target(self, item: XmlElement, table: Table) -> Table:
        """The scope that a property is defined in."""
        match item.get("scope"):
            case "global":
                return table.top()
            case "parent":
                return table.caller()
            case _:
                return table

    # macros and blocks

    def _macro(self, item: XmlElement, scope: Scope, _target: XmlElement) -> None:
        macro = read_macro(item)
        scope.macros[macro.name] = macro

    def _call(self, item: XmlElement, scope: Scope, target: XmlElement) -> None:
        """Replace a call with the content of the macro."""
        if item.tag == "xacro:call":
            name, given = str(self._of(item, "macro", scope)), dict(item.attributes)
            del given["macro"]
        else:
            name, given = item.tag.removeprefix(PREFIX), item.attributes
        macro, around = self._resolved(name, item, scope)
        inner = Scope(around.symbols.child(), around.macros.child())
        names = [each.name for each in macro.parameters]
        for key in given:
            if key not in names:
                hint = did_you_mean(key, [each for each in names if each[0] != "*"], "parameters")
                item.refuse(f"the macro '{macro.name}' has no parameter '{key}'", hint, at=key)
            inner.symbols[key] = self._of(item, key, scope)
        self._give_blocks(item, macro, scope, inner)
        for each in macro.parameters:
            if each.name not in given and not each.is_block:
                inner.symbols[each.name] = self._default(item, macro, each, scope)
        self._at = item
        target.children += self._inside(macro.body, inner).children

    def _resolved(self, name: str, item: XmlElement, scope: Scope) -> tuple[Macro, Scope]:
        """A macro, and the scope that it is expanded in."""
        found = scope
        *spaces, last = [name] if name in scope.macros else name.split(".")
        for space in spaces:
            macros, symbols = found.macros.get(space), found.symbols.get(space)
            if not isinstance(macros, Table) or not isinstance(symbols, Table):
                break
            found = Scope(symbols, macros)
        macro = found.macros.get(last)
        if not isinstance(macro, Macro):
            known = [each for each in found.macros.names() if isinstance(found.macros[each], Macro)]
            hint = did_you_mean(last, known, "macros")
            item.refuse(f"there is no macro '{name}'", hint)
        return macro, found

    def _give_blocks(self, item: XmlElement, macro: Macro, scope: Scope, inner: Scope) -> None:
        """Render the elements in a call, and give them to the parameters for blocks."""
        blocks = [
            each for each in self._inside(item, scope).children if each.tag not in (TEXT, LITERAL)
        ]
        expected = [each.name for each in macro.parameters if each.is_block]
        if len(blocks) > len(expected):
            blocks[len(expected)].refuse(f"the macro '{macro.name}' takes no block more")
        if len(blocks) < len(expected):
            name = expected[len(blocks)].lstrip("*")
            item.refuse(f"the macro '{macro.name}' lacks its block '{name}'")
        for name, block in zip(expected, blocks, strict=True):
            inner.symbols[name] = block

    def _default(self, item: XmlElement, macro: Macro, each: Parameter, scope: Scope) -> Any:
        """The default of a parameter, with the names that the caller has."""
        if each.is_forwarded and each.name in scope.symbols:
            return scope.symbols[each.name]
        if each.default is None:
            item.refuse(
                f"the macro '{macro.name}' lacks its parameter '{each.name}'",
                f'write {each.name}="..." in the call',
            )
        return self._texts.value(each.default, scope.symbols, macro.body.place_of("params"))

    def _insert_block(self, item: XmlElement, scope: Scope, target: XmlElement) -> None:
        name = item.need("name")
        if f"**{name}" in scope.symbols:
            target.children += self._inside(scope.symbols[f"**{name}"], scope).children
        elif f"*{name}" in scope.symbols:
            self._plain(scope.symbols[f"*{name}"], scope, target)
        else:
            item.refuse(f"there is no block '{name}'", at="name")

    # files

    def _include(self, item: XmlElement, scope: Scope, target: XmlElement) -> None:
        """Replace an include with what is in the root elements of the files."""
        name = str(self._of(item, "filename", scope))
        if "ns" in item.attributes:
            space = str(self._of(item, "ns", scope))
            scope.macros[space] = macros = Table(None, self._evaluate, is_namespace=True)
            scope.symbols[space] = symbols = scope.symbols.child(is_namespace=True)
            scope = Scope(symbols, macros)
        is_optional = self._truth(item, "optional", scope, "false")
        try:
            for path in self._files.matching(name, self._texts.missing_in(name)):
                root = self._files.document(path)
                target.children += self._inside(root, scope).children
                self._files.open.pop()
        except MissingFile as error:
            if not is_optional:
                item.refuse(error.message, at="filename")
        except ExpressionError as error:
            item.refuse(error.message, at="filename")
