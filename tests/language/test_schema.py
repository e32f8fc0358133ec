import json
from pathlib import Path

import jsonschema
import pytest

from docs.generators.expectations import expectations_reference
from docs.generators.reference import steps_reference
from harness.core.resources import data_folder
from harness.language.files.source import Source
from harness.language.files.yaml_file import parse_yaml
from harness.language.language import PREDICATES
from harness.language.step import STEPS
from harness.plugins.authoring.scenario_schema import scenario_schema, schema_text, world_schema

FILES = Path(__file__).parent / "files"
LESSONS = sorted(data_folder("scenarios").rglob("*.scenario.yaml"))
WORLDS = sorted(data_folder("worlds").glob("*.yaml"))
HEAD = "scenario: x\nrobot: ur3e\n"


def plain(text):
    return parse_yaml(text, Source.of_text("", text)).plain()


@pytest.fixture(scope="module")
def validator():
    schema = scenario_schema()
    jsonschema.Draft7Validator.check_schema(schema)
    return jsonschema.Draft7Validator(schema)


@pytest.mark.parametrize("path", [FILES / "design.yaml", *LESSONS], ids=lambda path: path.name)
def test_scenarios_that_load_validate(validator, path):
    assert not list(validator.iter_errors(plain(path.read_text(encoding="utf-8"))))


@pytest.mark.parametrize("path", WORLDS, ids=lambda path: path.name)
def test_worlds_validate(path):
    worlds = jsonschema.Draft7Validator(world_schema())
    assert not list(worlds.iter_errors(plain(path.read_text(encoding="utf-8"))))


@pytest.mark.parametrize(
    "text",
    [
        "steps: [settle, clear_objects: {world: true}, {gripper: {width: 3 cm}, id: a}]",
        "steps: [{repeat: {times: 2, steps: [{wait: 1}]}}, {parallel: [settle, {lin: up}]}]",
        "steps: [{add_object: {name: a, box: {size: [1 cm, 0.1, '${x}']}, in: planning}}]",
        "steps: [{move_to: {position: [1, 2, 3], pitch: 90 deg}, planning: {padding: 1 cm}}]",
        "steps: [settle]\nexpect: [within_limits, {lifted: a, for: 1 s}, {never: collision}]",
        "steps: [settle]\nexpect: [{always: {grasped: a}, until: {lifted: b}}, {formula: G(x)}]",
        "steps: [settle]\nseed: ${s}\nparams: {s: 1}",
    ],
)
def test_short_forms_units_and_references_validate(validator, text):
    assert not list(validator.iter_errors(plain(HEAD + text)))


@pytest.mark.parametrize(
    "text",
    [
        "steps: []",
        "steps: [{move_too: home}]",
        "steps: [{gripper: open, move_to: home}]",
        "steps: [{id: a}]",
        "steps: [lin]",
        "steps: [{move_to: {named_target: up, expect: []}}]",
        "steps: [{pick: {mode: friction}}]",
        "steps: [{grasp: {object: a, mode: glue}}]",
        "steps: [{lin: {pose: {xyz: [0.3, 0.1]}}}]",
        "steps: [{wait: soon}]",
        "steps: [settle]\nseed: -1",
        "steps: [settle]\nplanning: {max_velocity_scaling_factor: 1.5}",
        "steps: [settle]\nworl: empty",
        "steps: [settle]\nexpect: [{never: {colision: {}}}]",
        "steps: [settle]\nexpect: [{lifted: a, grasped: a}]",
        "steps: [settle]\nexpect: [{until: {lifted: a}}]",
        "steps: [settle]\nexpect: [{always: {never: {lifted: a}}}]",
        "steps: [{clear_objects: {world: yes}}]",
        "steps: [{do: settle}]",
    ],
)
def test_typical_mistakes_do_not_validate(validator, text):
    assert list(validator.iter_errors(plain(HEAD + text)))


def test_the_schema_offers_every_verb_and_predicate_with_its_meaning():
    definitions = scenario_schema()["$defs"]
    step = definitions["Step"]["anyOf"][0]["properties"]
    assert set(STEPS) < set(step)
    meaning = step["move_to"]["description"].splitlines()[0]
    assert meaning == "Plan a collision-free motion to a goal, then execute it."
    assert set(PREDICATES) < set(definitions["Expectation"]["anyOf"][0]["properties"])


def test_the_schemas_text_is_the_same_every_time():
    assert schema_text() == schema_text()
    assert json.loads(schema_text())["$schema"].endswith("draft-07/schema#")


def test_the_reference_names_every_verb_with_its_keys_units_and_defaults():
    text = steps_reference()
    assert all(f"\n## `{verb}`\n" in text for verb in STEPS)
    assert "| `width` | a length [m] |  | The gap between the pads becomes this wide [m]. |" in text
    assert "| `max_step` | a length [m] | `0.005` |" in text


def test_the_reference_says_when_a_bare_predicate_is_judged():
    text = expectations_reference()
    assert all(f"\n## `{predicate}`\n" in text for predicate in PREDICATES)
    clearance = text.split("## `clearance`")[1].split("##")[0]
    assert "it must hold at every sample" in clearance
    assert "Not yet available" not in text
