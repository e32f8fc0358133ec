"""No test changes what the tests after it find; nothing that they share depends on the first."""

import os
import sys

import pytest

from docs import ROOT
from tests.beginning import BEGINNING, as_before_tests

TESTS = """\
import os, signal, sys, tempfile

def state():
    os.umask(umask := os.umask(0))
    return (dict(os.environ) | {"PYTEST_CURRENT_TEST": ""}, os.getcwd(), list(sys.path),
            signal.getsignal(signal.SIGTERM), tempfile.tempdir, umask)

BEFORE = state()

def test_a_change(tmp_path):
    os.environ["NEW"] = "a"
    os.environ.pop("PATH")
    (tmp_path / "gone").mkdir()
    os.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    sys.path.insert(0, "somewhere")
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    tempfile.tempdir = "/elsewhere"
    os.umask(0o77)

def test_after_it():
    for now, before in zip(state(), BEFORE):
        assert now == before
"""


@pytest.mark.nightly
def test_no_test_changes_what_the_next_one_finds(pytester, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    pytester.makepyfile(TESTS)
    in_order = ("-p", "no:randomly")
    put_back = pytester.runpytest_subprocess(*in_order, "-p", "tests.beginning")
    put_back.assert_outcomes(passed=2)
    pytester.runpytest_subprocess(*in_order).assert_outcomes(passed=1, failed=1)


PLUGINS = """\
from harness.core.registry import register

class Planner: pass

if {at_import}:
    register(Planner, kind="planner", name="of_a_test")

def test_a_plugin():
    register(Planner, kind="planner", name="of_a_test")

def test_after_it(): pass
"""


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(("at_import", "errors"), [(False, 1), (True, 0)])
def test_a_plugin_that_a_test_leaves_registered_is_an_error(
    pytester, monkeypatch, at_import, errors
):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    pytester.makepyfile(PLUGINS.format(at_import=at_import))
    done = pytester.runpytest_subprocess("-p", "no:randomly", "-p", "tests.beginning")
    done.assert_outcomes(passed=2, errors=errors)
    assert ("stay registered" in done.stdout.str()) == bool(errors)


@pytest.mark.parametrize("is_removed", [False, True])
def test_what_tests_share_starts_where_the_process_began(tmp_path, monkeypatch, is_removed):
    folder = tmp_path / "of a test"
    folder.mkdir()
    monkeypatch.chdir(folder)
    monkeypatch.setenv("OF_A_TEST", "1")
    monkeypatch.syspath_prepend(folder)
    if is_removed:
        folder.rmdir()
    with as_before_tests():
        assert os.getcwd() == str(ROOT)  # noqa: PTH109
        assert "OF_A_TEST" not in os.environ
        assert os.environ["PATH"] == BEGINNING.environment["PATH"]
        assert str(folder) not in sys.path
    assert os.environ["OF_A_TEST"] == "1"
    assert sys.path[0] == str(folder)
