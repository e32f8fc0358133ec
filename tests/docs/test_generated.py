"""Schemas and reference pages in the repository are those that the models say."""

import json
import re

import jsonschema
import pytest
import yaml

from docs import ROOT
from docs.generate import GENERATED, RENEW
from docs.generators.worked_examples import example
from harness.cli.main import main
from harness.core.resources import data_folder
from harness.language.files.source import Source
from harness.language.files.yaml_file import parse_yaml
from harness.language.language import PREDICATES
from harness.language.step import STEPS

FILES = [
    *sorted(data_folder("scenarios").rglob("*.scenario.yaml")),
    *sorted(data_folder("worlds").glob("*.yaml")),
]
REFERENCES = [f"docs/reference/{name}.md" for name in ("scenario", "steps", "expectations")]
MODELINE = re.compile(r"# yaml-language-server: \$schema=(\S+)\n")


DECIMALS = re.compile(r"\d+\.\d+")


@pytest.mark.nightly(only=["README.md"])
@pytest.mark.parametrize("name", GENERATED)
def test_a_generated_file_is_current(name):
    written, made = (ROOT / name).read_text(encoding="utf-8"), GENERATED[name]()
    if name == "README.md":  # it shows a run, whose numbers depend on the processor family
        written, made = DECIMALS.sub("#", written), DECIMALS.sub("#", made)
    assert written == made, f"{name} is out of date; write it again: {RENEW}"


@pytest.mark.parametrize(
    ("words", "is_step", "page"), [(STEPS, True, "steps"), (PREDICATES, False, "expectations")]
)
def test_every_step_and_expectation_has_an_example_from_a_bundled_scenario(words, is_step, page):
    sections = (ROOT / f"docs/reference/{page}.md").read_text(encoding="utf-8").split("\n## ")
    by_word = {section.partition("`\n")[0].strip("`"): section for section in sections}
    for word in words:
        shown = example(word, is_step=is_step)
        assert shown in by_word[word]
        assert re.search(rf"\b{word}\b", shown.partition("```yaml")[2])
        yaml.safe_load(shown.partition("```yaml\n")[2].removesuffix("```"))


def test_the_schema_command_writes_the_committed_schema(tmp_path):
    assert main(["schema", "--write", str(tmp_path / "written.json")]) == 0
    written = (tmp_path / "written.json").read_text(encoding="utf-8")
    assert written == (ROOT / "scenarios/scenario.schema.json").read_text(encoding="utf-8")


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_a_bundled_file_names_a_schema_next_to_it_and_validates(path):
    text = path.read_text(encoding="utf-8")
    named = MODELINE.match(text)
    assert named, f"{path.name} does not begin with the line that editors read"
    schema = json.loads((path.parent / named[1]).read_text(encoding="utf-8"))
    content = parse_yaml(text, Source.of_text("", text)).plain()
    jsonschema.Draft7Validator(schema).validate(content)
    broken = {**content, "worl": "empty"}
    assert not jsonschema.Draft7Validator(schema).is_valid(broken)


@pytest.mark.parametrize("name", REFERENCES)
def test_a_reference_page_says_what_every_required_key_means(name):
    rows = re.findall(r"(?m)^\| (`\w+`) \|.*\| required \| (.*?) ?\|$", GENERATED[name]())
    assert rows
    assert not [key for key, meaning in rows if not meaning and not re.fullmatch("`i..`", key)]
