"""The worked examples use the public interface alone, and the example of a command works."""

import ast
import importlib
import json
import re

import pytest

from docs import ROOT
from harness.core.registry import registry
from tests.core.test_registry import install
from tests.docs.test_public_interface import MODULES
from tests.plugins.commands import MODULES as EXAMPLES
from tests.plugins.commands import harness

GUIDES = [*sorted((ROOT / "docs").rglob("*.md")), ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
FILES = [
    *EXAMPLES.glob("*.py"),
    ROOT / "tests/plugins/remarks.py",
    *(ROOT / "scenarios").rglob("*.py"),
]
BLOCK = re.compile(r"(?ms)^```python\n(.*?)^```")


def blocks():
    """Every worked example as its place and its code."""
    for page in GUIDES:
        for number, code in enumerate(BLOCK.findall(page.read_text(encoding="utf-8"))):
            yield pytest.param(code, id=f"{page.name}-{number}")
    for file in FILES:
        yield pytest.param(file.read_text(encoding="utf-8"), id=file.name)


def imported(code):
    """Module and name of every import from harness in a program."""
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("harness"):
            yield from ((node.module, each.name) for each in node.names)
        if isinstance(node, ast.Import):
            yield from ((each.name, "") for each in node.names if each.name.startswith("harness"))


@pytest.mark.parametrize("code", [*blocks()])
def test_an_example_imports_public_modules_and_their_names_alone(code):
    for module, name in imported(code):
        assert module in MODULES
        public = getattr(importlib.import_module(module), "__all__", None)
        kind = {"harness.steps": "step", "harness.expectations": "expectation"}.get(module)
        classes = {each.__name__ for each in registry(kind).built_in()} if kind else set()
        if name and public is not None:
            assert name in {*public, *classes, "TcpHeight"}  # that the guide adds to the repository


@pytest.mark.parametrize("kind", ["step", "expectation"])
def test_every_built_in_class_has_its_name_in_the_facade(kind):
    facade = importlib.import_module(f"harness.{kind}s")
    built_in = registry(kind).built_in()
    assert built_in
    for model in built_in:
        assert getattr(facade, model.__name__) is model
        assert model.__name__ not in facade.__all__


@pytest.mark.parametrize("name", ["Mooove", "movee", "__path_", "Step_"])
def test_a_class_that_is_not_built_in_is_an_attribute_error(name):
    facade = importlib.import_module("harness.steps")
    with pytest.raises(AttributeError, match=f"no built-in step of the class {name}"):
        getattr(facade, name)


@pytest.mark.nightly
def test_the_command_of_the_guide_runs_and_is_listed(tmp_path):
    page = (ROOT / "docs/guides/python.md").read_text(encoding="utf-8")
    (example,) = [block for block in BLOCK.findall(page) if "(Command)" in block]
    site = tmp_path / "site"
    site.mkdir()
    install(site, "tight-runs", "tight_runs", example)
    (tmp_path / "wait.scenario.yaml").write_text(
        "scenario: wait\nrobot: open_manipulator_x\nsteps: [{wait: 0.1}]\n"
        "expect: [{duration: {at_least: 0.05}}, {duration: {at_most: 0.2}}]\n"
    )
    harness(tmp_path, "run", "wait.scenario.yaml", "--report-dir", "out")
    (file,) = tmp_path.glob("out/**/run.json")
    smallest = min(each["margin"] for each in json.loads(file.read_text())["verdicts"])
    printed = harness(tmp_path, "tightest", file.parent, "--count", 1, site=site)
    assert printed.split()[:2] == [f"{smallest:g}", "s"]
    shown = " ".join(harness(tmp_path, "--help", site=site).split())
    assert "tightest print the expectations of a saved run" in shown
    (row,) = [
        row
        for row in harness(tmp_path, "list", "plugins", site=site).splitlines()
        if "tight-runs" in row
    ]
    assert "command tightest" in row
    assert "is not the folder of a run" in harness(tmp_path, "tightest", "x", site=site, code=2)
    assert "'tightest' is not valid" in harness(tmp_path, "tightest", "x", code=2)
