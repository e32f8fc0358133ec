"""JSON Schema of the scenario file as it is written: verbs as keys, short forms, units, `${name}`.

Made from pydantic's schema of the models, so that a field said once is offered by every editor.
Draft 7, which yaml-language-server completes from; `$defs` are plain references there.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any, cast

from pydantic import ValidationError
from pydantic.json_schema import GenerateJsonSchema, models_json_schema
from pydantic_core import core_schema

from harness.core.registry import registry
from harness.language.base import SpecModel
from harness.language.expectation import ExpectationFields, TemporalFields
from harness.language.language import (
    EXPECTATIONS,
    KEYS_BY_PREDICATE,
    KEYS_BY_VERB,
    PREDICATES,
    TEMPORAL,
    UNTIL,
)
from harness.language.plugin_field import MARK, KeyModel
from harness.language.scenario import Scenario
from harness.language.step import STEPS, StepFields
from harness.language.units import SHARE, written
from harness.language.world import WorldSpec

Schema = dict[str, Any]

REFERENCE: Schema = {"type": "string", "pattern": r"^\$\{[^{}]+\}$"}
QUANTITY = r"^\s*([-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*[A-Za-zµμ°].*|.*\$\{[^{}]+\}.*)$"
EXPRESSION = QUANTITY[:-2] + r"|[-+*/().\deE\s]*(pi|π|tau)[-+*/().\deEpitauπ\s]*|.*\d\s*[*/].*)$"
PERCENTAGE = r"^\s*([-+]?(\d+\.?\d*|\.\d+)\s*%|.*\$\{[^{}]+\}.*)$"
BOUNDS = {
    "gt": "exclusiveMinimum",
    "ge": "minimum",
    "lt": "exclusiveMaximum",
    "le": "maximum",
    "min_length": "minItems",
}
"""pydantic's words on a validated value -> JSON Schema's."""

MODEL = "model"  # in a model's schema while it is made: the model itself
DRAFT = "http://json-schema.org/draft-07/schema#"


def schema_text() -> str:
    """The scenario file's schema as text; the same for the same version of the program."""
    return _text(scenario_schema())


def world_schema_text() -> str:
    """The world file's schema as text."""
    return _text(world_schema())


def _text(schema: Schema) -> str:
    return json.dumps(schema, indent=1, ensure_ascii=False) + "\n"


def scenario_schema() -> Schema:
    """The scenario file's schema."""
    one_robot = [{"required": ["robot"]}, {"required": ["robots"]}]
    return {**_schema_of(Scenario, "A scenario for a robot arm"), "oneOf": one_robot}


def world_schema() -> Schema:
    """The world file's schema."""
    return _schema_of(WorldSpec, "A world of objects")


def _schema_of(model: type[SpecModel], title: str) -> Schema:
    models: list[type[SpecModel]] = [model, *registry(KeyModel.plugin_kind).values()]
    if model is Scenario:
        models += [*STEPS.values(), *_predicates_and_formula().values()]
    names, plain = models_json_schema(
        [(each, "validation") for each in models], by_alias=True, schema_generator=_WithUnits
    )
    definitions: dict[str, Schema] = plain["$defs"]
    own: dict[str, Schema] = {}
    for name, definition in definitions.items():
        own[name] = _with_short_form(_written(definition), definition[MODEL])
    if model is Scenario:
        own |= _language(own, {each: _name(names[each, "validation"]) for each in models})
    reached = own.pop(_name(names[model, "validation"]))
    head: Schema = {"$schema": DRAFT, "title": title}
    return {**head, **reached, "$defs": dict(sorted(_reachable(reached, own).items()))}


class _WithUnits(GenerateJsonSchema):
    """Keeps the units that a validator of numbers knows, and the class of each model."""

    def model_schema(self, schema: core_schema.ModelSchema) -> Schema:
        return {**super().model_schema(schema), MODEL: schema["cls"]}

    def function_before_schema(self, schema: core_schema.BeforeValidatorFunctionSchema) -> Schema:
        written_schema = super().function_before_schema(schema)
        function = schema["function"]["function"]
        units, also = getattr(function, "units", None), getattr(function, "schema", None)
        if also is not None:
            return {"anyOf": [written_schema, also]}
        return written_schema if units is None else {**written_schema, "units": units}


def _written(schema: Any) -> Any:
    """A part of pydantic's schema as a file may write it."""
    if isinstance(schema, list):
        return [_written(part) for part in cast("list[Any]", schema)]
    if not isinstance(schema, dict):
        return schema
    part = cast("Schema", schema)
    if MARK in part:
        return {"$ref": f"#/$defs/{part[MARK]}"}
    result: Schema = {
        key: {name: _written(each) for name, each in cast("Schema", value).items()}
        if key == "properties"
        else _written(value)
        for key, value in part.items()
        if key not in ("title", MODEL) and not (key == "default" and value is None)
    }
    if "properties" in part:
        return result
    return _with_references(_without_null(_draft_7(result)))


def _draft_7(schema: Schema) -> Schema:
    """Tuples of one kind as arrays of it; bounds in JSON Schema's words."""
    items: list[Schema] = schema.pop("prefixItems", [])
    if items:
        schema["items"] = items[0]
    for word, bound in BOUNDS.items():
        if word in schema:
            schema[bound] = schema.pop(word)
    if "exclusiveMinimum" in schema:
        schema.pop("minimum", None)
    return schema


def _without_null(schema: Schema) -> Schema:
    branches: list[Schema] = schema.get("anyOf", [])
    rest = [branch for branch in branches if branch != {"type": "null"}]
    if len(rest) == len(branches):
        return schema
    around = {key: value for key, value in schema.items() if key != "anyOf"}
    if len(rest) > 1:
        return {**around, "anyOf": rest}
    if "$ref" in rest[0] and around:
        return {**around, "allOf": rest}
    return {**rest[0], **around}


def _with_references(schema: Schema) -> Schema:
    """Allow `${name}` for a number, list or word, and text with a unit for a number."""
    units: tuple[str, ...] | None = schema.pop("units", None)
    around = {key: schema.pop(key) for key in ("description", "default") if key in schema}
    if units is not None:
        unit = f"{' or '.join(units)} (as text: {written(units)})"
        unit = "It is a number or a percentage" if units == SHARE else f"The unit is {unit}"
        around["description"] = f"{around.get('description', '')} {unit}.".strip()
        pattern = EXPRESSION if "rad" in units else PERCENTAGE if units == SHARE else QUANTITY
        return {**around, "anyOf": [schema, {"type": "string", "pattern": pattern}]}
    if schema.get("type") in ("number", "integer", "boolean", "array") or "enum" in schema:
        return {**around, "anyOf": [schema, REFERENCE]}
    return {**around, **schema}


def _with_short_form(definition: Schema, model: type[SpecModel]) -> Schema:
    """A model's schema without its tag, and the bare value that may stand for it."""
    properties: dict[str, Schema] = definition.get("properties", {})
    is_step, is_check = issubclass(model, StepFields), issubclass(model, ExpectationFields)
    hidden = {*KEYS_BY_VERB} - {*model.keys_inside} if issubclass(model, StepFields) else ()
    kept = {key: value for key, value in properties.items() if key not in hidden}
    mapping = {**definition, "properties": kept}
    branches: list[Schema] = [mapping]
    if model.short:
        short = {**kept[model.short]}
        short.pop("description", None)
        short.pop("default", None)
        branches.append(short)
        if model.short_is_list:
            array = short["anyOf"][0] if "anyOf" in short else short
            branches.append(array["items"])
    if (is_step or is_check) and _may_be_bare(model):
        branches.append({"type": "null"})
    elif is_step or is_check:
        mapping["minProperties"] = 1
    if len(branches) == 1:
        return mapping
    description = mapping.pop("description", "")
    return {"description": description, "anyOf": branches}


def _language(
    definitions: Mapping[str, Schema], names: Mapping[type[SpecModel], str]
) -> dict[str, Schema]:
    """Steps, predicates and expectations: one word, its content, and the keys next to it.

    Args:
        names: The names of models whose class has another name there.
    """

    def content(models: Mapping[str, type[SpecModel]]) -> dict[str, Schema]:
        return {
            word: {
                "description": definitions[name].get("description", ""),
                "allOf": [{"$ref": f"#/$defs/{name}"}],
            }
            for word, model in models.items()
            for name in [names.get(model, model.__name__)]
        }

    plain_step = _properties(StepFields)
    plain_check = _properties(TemporalFields)
    next_to_verb = {key: _written(plain_step[key]) for key in KEYS_BY_VERB}
    next_to_predicate = {
        key: _written(plain_check[key]) for key in KEYS_BY_PREDICATE if key in plain_check
    }
    bare_words = content(_predicates_and_formula())
    predicates = {word: bare_words[word] for word in PREDICATES}
    predicate = _one_word(predicates, next_to_predicate, PREDICATES)
    temporal = {
        word: {"description": model.__doc__ or "", "allOf": [{"$ref": "#/$defs/Predicate"}]}
        for word, model in TEMPORAL.items()
    }
    until: Schema = {
        UNTIL: {
            "description": "The predicate until which that of `always` must hold.",
            "allOf": [{"$ref": "#/$defs/Predicate"}],
        }
    }
    words = bare_words | temporal
    expectation = _one_word(words, next_to_predicate | until, PREDICATES)
    expectation["anyOf"][0]["dependencies"] = {UNTIL: ["always"]}
    return {
        "Step": _one_word(content(STEPS), next_to_verb, STEPS),
        "Predicate": predicate,
        "Expectation": expectation,
    }


def _predicates_and_formula() -> dict[str, type[ExpectationFields]]:
    """The expectations that have content of their own, which no temporal word has."""
    return {word: model for word, model in EXPECTATIONS.items() if word not in TEMPORAL}


def _one_word(
    words: Mapping[str, Schema],
    siblings: Mapping[str, Schema],
    models: Mapping[str, type[SpecModel]],
) -> Schema:
    bare = [word for word, model in models.items() if _may_be_bare(model)]
    mapping: Schema = {
        "type": "object",
        "properties": {**words, **siblings},
        "additionalProperties": False,
        "oneOf": [{"required": [word]} for word in words],
    }
    return {"anyOf": [mapping, {"type": "string", "enum": bare}]}


def _may_be_bare(model: type[SpecModel]) -> bool:
    """Whether a verb or predicate means something without content."""
    try:
        model.model_validate({})
    except ValidationError:
        return False
    return True


def _properties(model: type[SpecModel]) -> dict[str, Schema]:
    plain = model.model_json_schema(by_alias=True, schema_generator=_WithUnits)
    resolved = plain.get("$defs", {}).get(model.__name__, plain)
    return cast("dict[str, Schema]", resolved["properties"])


def _reachable(root: Schema, definitions: Mapping[str, Schema]) -> dict[str, Schema]:
    found: dict[str, Schema] = {}
    waiting = list(_references(root))
    while waiting:
        name = waiting.pop()
        if name not in found:
            found[name] = definitions[name]
            waiting += _references(definitions[name])
    return found


def _references(schema: Any) -> Iterable[str]:
    if isinstance(schema, dict):
        for key, value in cast("Schema", schema).items():
            if key == "$ref":
                yield _name({key: value})
            else:
                yield from _references(value)
    elif isinstance(schema, list):
        for value in cast("list[Any]", schema):
            yield from _references(value)


def _name(reference: Schema) -> str:
    """The name that a reference to a definition has."""
    return str(reference["$ref"]).rsplit("/", 1)[-1]
