"""A field that holds a model of a plug-in: the tag of its value chooses the model."""

from __future__ import annotations

from typing import Any, cast

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import PydanticCustomError, core_schema

from harness.core.registry import registry
from harness.language.base import SpecModel

MARK = "plugin"
"""In a field's JSON Schema: the kind of plug-in that it holds."""


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
        return {MARK: self.kind}

    def _validate(self, value: object) -> SpecModel:
        given = cast("dict[str, Any]", value) if isinstance(value, dict) else {}
        models = registry(self.kind)
        word = given.get(self.tag)
        if not isinstance(word, str) or word not in models:
            message = f"{self.tag} names no {self.kind}"
            raise PydanticCustomError("union_tag_invalid", message)  # pyright: ignore[reportArgumentType]
        model: type[SpecModel] = models[word]
        return model.model_validate({key: item for key, item in given.items() if key != self.tag})
