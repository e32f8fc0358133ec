"""The public interface is declared, importable, typed and documented."""

import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest

import harness
from docs import ROOT

PAGE = (ROOT / "docs/guides/python.md").read_text(encoding="utf-8")
PAGES = PAGE + (ROOT / "docs/guides/ik_test.md").read_text(encoding="utf-8")
ROWS = re.findall(r"(?m)^\| (.*?) \|", PAGE.split("## Public interface")[1])
MODULES = sorted({name for row in ROWS for name in re.findall(r"`(harness[\w.]*)`", row)})
PROGRAM = """\
import harness

result = harness.run("a.scenario.yaml", seed=3)
reveal_type(result.case.digest)
"""


def test_the_page_lists_the_modules_of_the_public_interface():
    assert {
        "harness",
        "harness.expectations",
        "harness.plugins.iktest",
        "harness.plugins.iktest.strategies",
    } <= {*MODULES}


@pytest.mark.parametrize("module", MODULES)
def test_every_public_name_exists_and_is_documented(module):
    loaded = importlib.import_module(module)
    names = getattr(loaded, "__all__", [])
    assert [name for name in names if not hasattr(loaded, name)] == []
    assert [name for name in names if not re.search(rf"\b{re.escape(name)}\b", PAGES)] == []


def test_the_interface_of_the_package_is_what_it_defines():
    defined = {name for name, value in vars(harness).items() if callable(value)}
    own = {name for name in defined if getattr(harness, name).__module__ == "harness"}
    assert own | {"__version__"} == {*harness.__all__}


@pytest.mark.nightly
def test_a_program_that_uses_the_interface_passes_a_type_checker(tmp_path):
    pytest.importorskip("pyright")
    assert (Path(harness.__file__).parent / "py.typed").is_file()
    assert 'Type of "result.case.digest" is "str"' in checked(tmp_path, PROGRAM, code=0)
    assert '"seed"' in checked(tmp_path, PROGRAM.replace("3", "'three'"), code=1)


def checked(folder, text, code):
    """What pyright prints about a program."""
    (folder / "program.py").write_text(text, encoding="utf-8")
    command = [sys.executable, "-m", "pyright", "--pythonpath", sys.executable, "program.py"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == code, done.stdout
    return done.stdout
