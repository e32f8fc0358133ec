"""Every command and every output on a page is carried out by a test, or is of a listed program.

The `harness` commands and the outputs of example pages have `test_guides.py` and
`test_examples.py`; here is everything else that stands in a block.
"""

import configparser
import importlib.util
import json
import re
import shlex
import subprocess
import sys
import tomllib
from itertools import chain
from pathlib import Path
from xml.etree import ElementTree

import pytest

from docs import ROOT
from docs.generate import GENERATED
from tests.docs.test_examples import EVERY_PAGE, PAGES, blocks, every_command, page_id
from tests.docs.test_guides import BY_THE_SHELL, GUIDES
from tests.extras import PREFIX

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS = PROJECT["optional-dependencies"]
OTHER_PROGRAMS = {"ros2": "ROS 2", "rviz2": "RViz", "rerun": "Rerun"}
"""Programs that no extra installs, and the name by which their page introduces them."""
CHECKS = ("ruff", "pyright", "lint-imports")  # tests/docs/test_contributing.py, and .ci/run
EXTENDING = "docs/guides/extending.md"  # tests/docs/test_contributing.py carries it out
OWN_PYTEST = "README.md"  # tests/system/test_packaging.py compares its command with that of CI
HEADERS = ROOT / "docs/guides/platforms.md"  # a test below looks for what it removes

PRINTED = {
    "docs/guides/bring_your_own_arm.md": "tests/packages/test_bring_your_own_arm.py",
    EXTENDING: "tests/docs/test_contributing.py",
    "docs/guides/grading.md": "tests/docs/test_guides.py",
    "docs/guides/ik_test.md": "tests/system/test_ik_test.py",
    "docs/guides/pipelines.md": "tests/plugins/ci/test_pipelines.py",
    "docs/reference/ik_packages.md": "tests/plugins/iktest/test_packages.py",
}
"""Tests that print the `text` blocks of a page again, besides those of examples and the course."""


def program(words):
    """The name of the program of a command, without settings of variables in front of it."""
    return Path(next(word for word in words if "=" not in word)).name


def is_known(page, words):
    """Whether a command is carried out or checked elsewhere, or is of a listed program."""
    name, after = program(words), words[words.index("-m") + 1] if "-m" in words else ""
    if name in OTHER_PROGRAMS:
        return OTHER_PROGRAMS[name] in page.read_text(encoding="utf-8")
    if name in BY_THE_SHELL or (name, after) == ("python", "pytest"):
        is_of_clone = "tests/" in " ".join(words) or words[-1].startswith(PREFIX)
        return page in GUIDES or is_of_clone or page_id(page) == OWN_PYTEST
    if name == "rm":
        return page == HEADERS
    if name == "pip":
        return are_declared(words[words.index("install") + 1 :])
    if name in ("python", "python3"):
        return after == "venv" or (ROOT / f"{after.replace('.', '/')}.py").is_file()
    return name in ("harness", *CHECKS)


def are_declared(words):
    """Whether what pip installs are extras and packages of this project."""
    declared = re.findall(r"(?m)^[\w-]+", "\n".join(chain(*EXTRAS.values())))
    for word in words:
        extras = re.fullmatch(r"\.\[(.*)\]", word)
        known = extras[1].split(",") if extras else [word]
        is_option = word in ("-q", "-e", "-c", "--no-compile", ".") or (ROOT / word).is_file()
        if not is_option and not {*known} <= {*(EXTRAS if extras else declared)}:
            return False
    return True


@pytest.mark.parametrize("page", EVERY_PAGE, ids=page_id)
def test_every_command_is_carried_out_or_of_a_listed_program(page):
    for words in every_command(page):
        if page not in PAGES and words[:1] != ["."]:
            assert is_known(page, words), shlex.join(words)


@pytest.mark.parametrize(
    "command",
    [
        "rosbag play bag",
        "pip install '.[rviz]'",
        "python -m harnes.run",
        "docker run ros",
    ],
)
def test_a_command_that_nothing_carries_out_is_found(command):
    assert not is_known(ROOT / "docs/guides/costs.md", shlex.split(command))


def test_another_program_is_introduced_where_it_is_named():
    assert not is_known(ROOT / "docs/guides/costs.md", ["rviz2"])
    found = {program(words) for page in EVERY_PAGE for words in every_command(page)}
    assert {*OTHER_PROGRAMS} <= found


PYTEST = [
    pytest.param(words, id=f"{page.stem}-{number}")
    for page in EVERY_PAGE
    if page not in PAGES and page_id(page) != EXTENDING
    for number, words in enumerate(every_command(page))
    if "pytest" in words and any("tests/" in word for word in words)
]


@pytest.mark.nightly
@pytest.mark.parametrize("words", PYTEST)
def test_the_pytest_commands_of_pages_find_tests(words):
    arguments = words[words.index("pytest") + 1 :]
    command = [sys.executable, "-m", "pytest", "--collect-only", "-q", *arguments]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    needs_an_extra = done.returncode == 5 and "SKIPPED" in done.stdout
    assert done.returncode == 0 or needs_an_extra, done.stdout + done.stderr


def test_the_headers_that_a_page_removes_are_where_it_says():
    text = HEADERS.read_text(encoding="utf-8")
    [folder] = re.findall(r"(?m)^rm -r \.venv/lib/python3\.\*/site-packages/(.*)$", text)
    found = Path(importlib.util.find_spec("pinocchio").origin)
    site = next(each for each in found.parents if (each / "cmeel.prefix").is_dir())
    assert (site / folder / "pinocchio").is_dir()


@pytest.mark.parametrize("page", EVERY_PAGE, ids=page_id)
def test_a_test_prints_every_output_of_a_page_again(page):
    shown = [block["text"] for block in blocks(page) if block["language"] == "text"]
    if not shown or page in PAGES or page.parent.name == "course" or page_id(page) in GENERATED:
        return
    test = PRINTED[page_id(page)]
    text = (ROOT / test).read_text(encoding="utf-8")
    if test == "tests/docs/test_guides.py":
        assert page in GUIDES
        assert all(each.startswith("$ harness ") for each in shown), "of which command is this?"
    else:
        assert page.name in text or "ROW" in text


def test_the_outputs_of_the_course_have_marks_of_its_generator():
    for page in (ROOT / "docs/course").glob("*.md"):
        text = page.read_text(encoding="utf-8")
        without = re.sub(r"(?ms)^<!-- \w+ -->$.*?^<!-- end -->$", "", text)
        assert "```text" not in without, page.name


READERS = {
    "json": json.loads,
    "toml": tomllib.loads,
    "ini": lambda text: configparser.ConfigParser().read_string(text),
    "xml": ElementTree.fromstring,
}
KNOWN = {"sh", "console", "text", "yaml", "python", "eval-rst", *READERS}


@pytest.mark.parametrize("page", EVERY_PAGE, ids=page_id)
def test_every_block_is_of_a_known_language_and_can_be_read(page):
    fences = re.findall(r"(?m)^```([^\n`]+)$", page.read_text(encoding="utf-8"))
    assert {each.strip("{}").partition(" ")[0] for each in fences} <= KNOWN
    for block in blocks(page):
        READERS.get(block["language"], str)(block["text"])
