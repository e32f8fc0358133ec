"""What is valid of a file with mistakes, so that the rest of it is checked too."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, cast, get_args, get_origin

from pydantic import TypeAdapter, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from harness.core.registry import registry
from harness.language.annotations import branches, is_model, plugin_model, spelling
from harness.language.base import SpecModel
from harness.language.expectation import KIND
from harness.language.files.source import Loc
from harness.language.language import PLACEHOLDER_VERB, PLACEHOLDER_WORD
from harness.language.plugin_field import PluginField
from harness.language.scenario import RobotSpec, Scenario
from harness.language.step import StepFields

Prerequisite = Literal["robot", "world", "arms"]

ABSENT: Any = object()  # in place of a value that cannot be read and that nothing can stand in for
NO_NAME = "?"  # stands in for a name that cannot be read; problems with it follow from that
STAND_INS = (1, 0, True, NO_NAME)  # the first valid one stands in for a value that is needed

PLACEHOLDERS = {StepFields.plugin_kind: PLACEHOLDER_VERB, KIND: PLACEHOLDER_WORD}
"""By the kind of plug-in, the name of the one that stands in for one that is unknown."""

STAND_IN_ROBOT = "open_manipulator_x"  # so that what does not depend on the robot is checked

ROBOT_DETAILS = ("base", "start_state", "joint_limits", "named_states", "moveit", "args")
"""Keys of `robot` without which it is the same arm."""

ITEMS = ("steps", "expect", "objects")  # lists of a scenario whose items are read in part


@dataclass
class PartialReader:
    """Reads what is valid, value by value; validators of models with mistakes do not run.

    Attributes:
        words: Every word of what cannot be read: problems that name one may follow from it.
        missing: `robot` or `world`, where something else stands in for it; `arms`, where a key of
            `robot` is unknown, which may have named them.
        broken_rules: Errors of rules of whole models ("exactly one goal"), which pydantic does
            not check while a field cannot be read.
    """

    words: set[str] = field(default_factory=set[str])
    missing: set[Prerequisite] = field(default_factory=set[Prerequisite])
    broken_rules: list[ErrorDetails] = field(default_factory=list[ErrorDetails])

    def scenario(self, data: dict[str, Any], places: list[Loc]) -> Scenario:
        """What is valid of a scenario.

        Args:
            data: A scenario in the model's shape.
            places: Where pydantic found mistakes.
        """
        valid = self.model(Scenario, data, ())
        values = {name: getattr(valid, name) for name in valid.model_fields_set if name in data}
        for key in {str(place[0]) for place in places if place} - {*ITEMS}:
            parts = {str(place[1]) for place in places if place[0:1] == (key,) and len(place) > 1}
            rest = self._without(data, key, parts)
            values.pop(key, None)
            if rest is not ABSENT:
                values[key] = _read(_annotation(Scenario.model_fields[key]), rest)
        values = {"scenario": "untitled", "steps": (), **values}
        if all(values.get(key, ABSENT) in (ABSENT, None) for key in ("robot", "robots")):
            self.missing.add("robot")
            values["robot"] = RobotSpec(model=STAND_IN_ROBOT)
        values = {name: value for name, value in values.items() if value is not ABSENT}
        return Scenario.model_construct(_fields_set=set(values), **values)

    def _without(self, data: dict[str, Any], key: str, parts: set[str]) -> Any:
        """The value of a key without its broken parts; `ABSENT` where little would be left."""
        value: Any = data.get(key, ABSENT)
        if isinstance(value, dict) and parts and key not in ("world", "robots"):
            mapping = cast("dict[str, Any]", value)
            if parts <= mapping.keys() and (key != "robot" or parts <= {*ROBOT_DETAILS}):
                for part in parts:
                    self.words.update(texts(mapping[part]))
                return {name: item for name, item in mapping.items() if name not in parts}
        self.words.update(texts(value))
        if key == "world":
            self.missing.add("world")
        return ABSENT

    def model(self, model: type[SpecModel], data: dict[str, Any], loc: Loc) -> SpecModel:
        """Build a model of what is valid of a mapping.

        A required field that cannot be read has a value that stands in for it, or none, so that
        reading it raises AttributeError.
        """
        values: dict[str, Any] = {}
        unreadable: dict[str, Any] = {}
        for name, info in model.model_fields.items():
            keys = [key for key in (name, info.alias) if key in data]
            annotation, is_needed = _annotation(info), info.is_required()
            if keys:
                value = _read(annotation, data[keys[0]])
                if value is ABSENT:
                    unreadable[name] = _UNREADABLE
                    at = (*loc, spelling(name, info))
                    value = self._value(annotation, data[keys[0]], at, is_needed)
                    if value is ABSENT:  # what is called so lacks a part
                        self.words.update(texts(data.get("name")))
                values[name] = value
            elif is_needed:
                unreadable[name] = _UNREADABLE
                values[name] = self._stand_in(annotation, (*loc, name))
        valid = {name: value for name, value in values.items() if value is not ABSENT}
        if unreadable:
            self._check_rules(model, valid | unreadable, loc)
        return model.model_construct(_fields_set=set(valid), **valid)

    def _check_rules(self, model: type[SpecModel], values: dict[str, Any], loc: Loc) -> None:
        """Note the rule of a model that is broken whatever the values of unreadable fields are."""
        probe = model.model_construct(_fields_set=set(values), **values)
        for name, rule in model.__pydantic_decorators__.model_validators.items():
            if rule.info.mode != "after":
                continue
            try:
                getattr(probe, name)()
            except ValueError as error:
                about: ErrorDetails = {
                    "type": "value_error",
                    "loc": loc,
                    "msg": str(error),
                    "input": {},
                }
                self.broken_rules.append({**about, "ctx": {"error": error}})
                return
            except Exception:  # noqa: BLE001 - the rule is about a value that is not known
                continue

    def _plugin(self, plugin: PluginField, data: Any, loc: Loc) -> SpecModel:
        """What is valid of a step or an expectation; a placeholder where its name is unknown."""
        given = cast("dict[str, Any]", data) if isinstance(data, dict) else {}
        models, name = registry(plugin.kind), given.get(plugin.tag)
        if not isinstance(name, str) or name not in models:
            self.words.update(texts(data))
            name = PLACEHOLDERS[plugin.kind]
        return self.model(models[name], given, loc)

    def _value(self, annotation: Any, value: Any, loc: Loc, is_needed: bool = True) -> Any:
        """Read a value, or what is valid of it; where it is needed another may stand in for it."""
        valid = _read(annotation, value)
        if valid is ABSENT:
            valid = self.part(annotation, value, loc)
        if valid is not ABSENT:
            return valid
        self.words.update(texts(value))
        return self._stand_in(annotation, loc) if is_needed else ABSENT

    def part(self, annotation: Any, value: Any, loc: Loc) -> Any:
        """Read what is valid of a mapping or a list."""
        origin, arguments = get_origin(annotation), get_args(annotation)
        if origin is Annotated:
            plugin = next((each for each in arguments if isinstance(each, PluginField)), None)
            if plugin is not None:
                return self._plugin(plugin, value, loc)
            return self.part(plugin_model(annotation) or arguments[0], value, loc)
        for branch in branches(annotation):
            part = self.part(branch, value, loc)
            if part is not ABSENT:
                return part
        if is_model(annotation) and annotation.short and not isinstance(value, dict | list):
            value = {annotation.short: value}
        if isinstance(value, dict):
            given = cast("dict[str, Any]", value)
            if is_model(annotation):
                return self.model(annotation, given, loc)
            if origin is dict:
                items = {
                    key: self._value(arguments[1], item, (*loc, key)) for key, item in given.items()
                }
                return {key: item for key, item in items.items() if item is not ABSENT}
        if isinstance(value, list) and origin is tuple:
            return self._items(arguments, cast("list[Any]", value), loc)
        return ABSENT

    def _items(self, arguments: tuple[Any, ...], values: list[Any], loc: Loc) -> Any:
        """Read the items of a list up to one that nothing can stand in for."""
        if arguments[-1] is Ellipsis:
            arguments = (arguments[0],) * len(values)
        items = [
            self._value(argument, values[index], (*loc, index))
            if index < len(values)
            else self._stand_in(argument, loc)
            for index, argument in enumerate(arguments)
        ]
        return tuple(items[: items.index(ABSENT)] if ABSENT in items else items)

    def _stand_in(self, annotation: Any, loc: Loc) -> Any:
        """Give a value that is valid for an annotation; `ABSENT` where none is known."""
        self.words.add(NO_NAME)
        choices = get_args(annotation) if get_origin(annotation) is Literal else ()
        values = (_read(annotation, each) for each in (*choices, *STAND_INS))
        empty: tuple[Any, Any] = {}, []
        models = (PartialReader().part(annotation, each, loc) for each in empty)
        return next((each for each in (*values, *models) if each is not ABSENT), ABSENT)


class _Unreadable:
    """A value that is given and not known: it is not None, and all else about it is an error."""

    def _refuse(self, *_: object) -> Any:
        raise TypeError("the value is not known")

    __bool__ = __eq__ = __ne__ = __getattr__ = __hash__ = __iter__ = __len__ = _refuse


_UNREADABLE = _Unreadable()


def _annotation(info: FieldInfo) -> Any:
    """The annotation of a field with its metadata, of which pydantic has taken it apart."""
    return Annotated[info.annotation, *info.metadata] if info.metadata else info.annotation


def _read(annotation: Any, value: Any) -> Any:
    try:
        return TypeAdapter[Any](annotation).validate_python(value)
    except ValidationError:
        return ABSENT


def texts(value: Any) -> Iterator[str]:
    """Yield every text of a part of a file, its keys included."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for key, item in cast("dict[str, Any]", value).items():
            yield key
            yield from texts(item)
    elif isinstance(value, list):
        for item in cast("list[Any]", value):
            yield from texts(item)
