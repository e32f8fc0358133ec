"""No test changes what the tests after it find; nothing that they share depends on the first."""

import os
import sys

import pytest

from docs import ROOT
from tests.beginning import ENVIRONMENT, as_before_tests

TESTS = """\
import os, signal, sys, tempfile

def test_environment(): os.environ["NEW"] = "a"
def test_folder(tmp_path): os.chdir(tmp_path)
def test_path(): sys.path.insert(0, "somewhere")
def test_signals(): signal.signal(signal.SIGTERM, signal.SIG_IGN)
def test_temporary(): tempfile.tempdir = "/elsewhere"
def test_umask(): os.umask(0o77)
def test_what_is_put_back(monkeypatch, tmp_path):
    monkeypatch.setenv("NEWER", "a")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
"""


def test_a_test_that_changes_its_process_is_an_error(pytester, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    pytester.makepyfile(TESTS)
    pytester.runpytest_subprocess("-p", "tests.beginning").assert_outcomes(passed=7, errors=6)


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
        assert os.environ["PATH"] == ENVIRONMENT["PATH"]
        assert str(folder) not in sys.path
    assert os.environ["OF_A_TEST"] == "1"
    assert sys.path[0] == str(folder)
