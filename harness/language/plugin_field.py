"""Fields that hold a model of a plug-in, or the name of one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, cast

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import PydanticCustomError, core_schema

from harness.core.registry import absent_plugins, noun, plugin_hints, registry
from harness.language.base import SpecModel
from harness.language.files.mistakes import MistakeError

MARK = "plugin"  # in a field's JSON Schema: the definition of what it holds


class PluginField:
    """Annotates a field of plug-in models: `Annotated[Step, PluginField("step", "do")]`.

    The lookup happens when a value is validated, so that a model is built when a file uses it.
    """

    def __init__(self, kind: str, tag: str) -> None:
        self.kind, self.tag = kind, tag

    def __get_pydantic_core_schema__(
        self, source: Any, _: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        def validate(value: object) -> SpecModel:
            return cast("SpecModel", value) if isinstance(value, source) else self._validate(value)

        return core_schema.no_info_plain_validator_function(validate)

    def __get_pydantic_json_schema__(
        self, _: core_schema.CoreSchema, __: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {MARK: self.kind.capitalize()}

    def _validate(self, value: object) -> SpecModel:
        given = cast("dict[str, Any]", value) if isinstance(value, dict) else {}
        models = registry(self.kind)
        word = given.get(self.tag)
        if not isinstance(word, str) or word not in models:
            message = f"{self.tag} names no {self.kind}"
            raise PydanticCustomError("union_tag_invalid", message)  # pyright: ignore[reportArgumentType]
        model: type[SpecModel] = models[word]
        return model.model_validate({key: item for key, item in given.items() if key != self.tag})


class KeyModel(SpecModel):
    """What a key of a file holds that belongs to a plug-in, such as `mount` of a robot."""

    plugin_kind: ClassVar[str] = "key"
    key: ClassVar[str] = ""

    @classmethod
    def plugin_name(cls) -> str:
        """The key that this class is registered under."""
        return cls.__dict__.get("key", "")

    def expectation(self) -> tuple[str, str] | None:
        """The field that names an expectation of the same file, and that name; None without."""


class PluginModel:
    """Annotates a field with the model of a plug-in: `Annotated[KeyModel, PluginModel("mount")]`.

    The model is imported when a file uses the key.
    """

    def __init__(self, key: str) -> None:
        self.key = key

    @property
    def model(self) -> type[KeyModel] | None:
        """The model; None where its plug-in is not installed."""
        return registry(KeyModel.plugin_kind).get(self.key)

    def __get_pydantic_core_schema__(
        self, _: Any, __: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self._validate)

    def __get_pydantic_json_schema__(
        self, _: core_schema.CoreSchema, __: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {} if self.model is None else {MARK: self.model.__name__}

    def _validate(self, value: object) -> KeyModel:
        if self.model is None:
            raise MistakeError("no plug-in applies this key here", "; ".join(absent_plugins()))
        return self.model.model_validate(value)


class PluginName:
    """Annotates a field with the name of a plug-in: `Annotated[Name, PluginName("planner")]`.

    Only the name is looked up; the plug-in is imported when it is used.
    """

    def __init__(
        self,
        kind: str,
        also: tuple[str, ...] = (),
        refused: Mapping[str, tuple[str, str]] | None = None,
    ) -> None:
        """Annotate a field.

        Args:
            also: Words that are valid too, and name no plug-in.
            refused: Words that people write -> what is wrong with them, and what to write instead.
        """
        self.kind, self.also, self.refused = kind, also, refused or {}

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_after_validator_function(self._check, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {**handler(schema), "enum": [*self.also, *registry(self.kind)]}

    def _check(self, name: str) -> str:
        known = registry(self.kind)
        if name in self.also or name in known:
            return name
        if name in self.refused:
            raise MistakeError(*self.refused[name])
        what = noun(self.kind)
        hints = plugin_hints(name, [*self.also, *known], what)
        raise MistakeError(f"there is no {what} `{name}`", "; ".join(hints))
