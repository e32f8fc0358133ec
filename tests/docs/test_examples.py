"""The examples of pages run as a reader runs them, and print what the pages show."""

import json
import re
import shlex
from functools import cache

import jsonschema
import pytest
import yaml

from docs import ROOT
from docs.generators.examples import (
    BLOCK,
    COLUMNS,
    PAGES,
    RENEW,
    commands,
    comparable,
    printed_again,
    shown,
)
from harness.cli.main import parser_of
from harness.language.files.source import Source
from harness.language.files.yaml_file import parse_yaml
from harness.plugins.authoring.scenario_schema import schema_text

EVERY_PAGE = sorted(
    {
        *(ROOT / "docs").rglob("*.md"),
        *ROOT.glob("*.md"),
        *(ROOT / "scenarios").rglob("*.md"),
        *PAGES,
    }
)
IN_DEFAULT_RUN = ["verdicts.md"]
OWN_WORDS = ("python.md", "extending.md")
"""Pages whose scenarios have words of plug-ins; other tests run them."""


@cache
def schema():
    return jsonschema.Draft7Validator(json.loads(schema_text()))


def blocks(page):
    return [*BLOCK.finditer(page.read_text(encoding="utf-8"))]


def harness_commands(page):
    """The words of every `harness` command of a page."""
    for words in every_command(page):
        names = [number for number, word in enumerate(words) if word.endswith("harness")]
        if names and "pip" not in words:
            yield words[names[0] + 1 :]


def every_command(page):
    """The words of every command of a page, without pipes and redirections."""
    for block in blocks(page):
        shows = block["text"].startswith("$ ")
        if block["language"] not in ("sh", "console") and not shows:
            continue
        for line in shown(block["text"]) if shows else commands(block["text"]):
            for part in re.split(r"\s(?:&&|\|)\s|;\s", line):
                known = re.sub(r"\s2?>.*", "", re.sub(r"\$\w+", "2", part))  # variables of a shell
                if words := shlex.split(known, comments=True):
                    yield words


def page_id(page):
    return page.relative_to(ROOT).as_posix()


@pytest.mark.nightly(but=IN_DEFAULT_RUN)
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_page_shows_what_its_commands_print(page, tmp_path):
    text = page.read_text(encoding="utf-8")
    printed = printed_again(text, tmp_path)
    renew = f"print it again: {RENEW} {page_id(page)}"
    assert comparable(printed) == comparable(text), renew


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_block_of_an_example_page_is_carried_out(page):
    for block in blocks(page):
        is_shown = block["language"] == "text" and block["text"].startswith("$ ")
        is_of_moveit = block["language"] == "python" and "moveit" in block["text"]
        is_run = block["file"] or block["language"] == "sh" or is_shown
        assert is_run or is_of_moveit or is_set_up(block), block[0]


def is_set_up(block):
    """Whether a block installs as the README does; `tests/system/test_packaging.py` does so."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    return block["language"] == "console" and all(
        line in readme for line in block["text"].splitlines()
    )


def test_the_steps_next_to_the_calls_of_moveit_are_those_of_the_lesson():
    page = (ROOT / "docs/howto/from_moveit.md").read_text(encoding="utf-8")
    shown = re.findall(r"(?m)^\| \d+ \| .* \| `(.*)` \|$", page)
    lesson = ROOT / "scenarios/lessons/03_ur_sixteen_steps.scenario.yaml"
    steps = yaml.safe_load(lesson.read_text(encoding="utf-8"))["steps"]
    numbered = [step for step in steps if step.get("id", "").startswith("step_")]
    for step in numbered:
        del step["id"]
        step.pop("expect", None)
    assert [yaml.safe_load(step) for step in shown] == numbered
    assert len(shown) == 16


SHOWING = [*PAGES, *sorted((ROOT / "docs/course").glob("*.md"))]


@pytest.mark.parametrize("page", SHOWING, ids=page_id)
def test_what_a_page_shows_is_not_wider_than_the_page(page):
    for block in blocks(page):
        lines = block["text"].splitlines() if block["language"] == "text" else []
        for line in (each for each in lines if not each.startswith("$ ")):
            words = line.split()
            assert len(line) <= COLUMNS or len(words) == 1 or len(words[0]) > 60, line


def test_a_page_that_shows_something_else_is_found(tmp_path):
    page = "`a.txt`:\n\n```text\nfirst\n```\n\n```text\n$ cat a.txt\nsecond\n```\n"
    assert printed_again(page, tmp_path) == page.replace("second", "first")
    with pytest.raises(RuntimeError, match="no_such_file"):
        printed_again("```sh\ncat no_such_file\n```\n", tmp_path)


@pytest.mark.parametrize("page", EVERY_PAGE, ids=page_id)
def test_every_command_of_a_page_is_one_that_the_program_takes(page, capsys):
    for words in harness_commands(page):
        assert refusal_of(words, capsys) == "", words


def refusal_of(words, capsys):
    """What the command line says against the words of a command; nothing is carried out."""
    try:
        parser_of(words).parse_args(words)
    except SystemExit as end:
        return capsys.readouterr().err if end.code else ""
    return ""


def test_a_command_that_the_program_refuses_is_found(capsys):
    assert "--no-such" in refusal_of(["check", "a", "--no-such"], capsys)
    assert "no_such_command" in refusal_of(["no_such_command"], capsys)


def described(block):
    """The scenario that a YAML block is, or is a part of; None for files of other programs."""
    text = block["text"]
    if text.startswith("- "):
        text = f"steps:\n{text}"
    content = parse_yaml(text, Source.of_text("a page", text)).plain()  # `on` is a word, not true
    if {*content} & {"jobs", "include", "kind", "arm", "assignment"}:
        return None
    robot = {} if "robots" in content else {"robot": "ur3e"}
    return {"scenario": "x", **robot, "steps": [{"wait": 1}], **content}


@pytest.mark.parametrize("page", EVERY_PAGE, ids=page_id)
def test_every_yaml_block_of_a_page_keeps_the_schema(page):
    if page.name in OWN_WORDS:
        return
    for block in blocks(page):
        content = described(block) if block["language"] == "yaml" else None
        if content is not None:
            problems = [*schema().iter_errors(content)]
            assert not problems, f"{block[0]}\n{problems[0].message}"


def test_a_yaml_block_with_a_wrong_key_is_found():
    (block,) = BLOCK.finditer("```yaml\n- pick: {object: cup, lifts: 2}\n```")
    assert [*schema().iter_errors(described(block))]
