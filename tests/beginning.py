"""Every test finds the process as it was before any test, and so does what tests share.

Whichever test is the first of its process has the same environment and folder as any other.
"""

import os
import signal
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from docs import ROOT

ENVIRONMENT, PATHS = dict(os.environ), tuple(sys.path)

tempfile.gettempdir()  # Python looks for it once: a test may have another one in its environment

OF_LIBRARIES = {
    "LD_LIBRARY_PATH",
    "PYTEST_CURRENT_TEST",
    "QT_QPA_FONTDIR",
    "QT_QPA_PLATFORM_PLUGIN_PATH",
}
"""Variables that pytest sets, and OpenCV when it is imported."""


@pytest.fixture(autouse=True)
def _leaves_the_process_as_it_was():
    before = _state()
    yield
    after = _state()
    changed = {name: (before[name], after[name]) for name in before if before[name] != after[name]}
    assert not changed, "the test changed what the tests after it find"


def _state():
    os.umask(umask := os.umask(0))
    return {
        "environment": {key: os.environ[key] for key in os.environ if key not in OF_LIBRARIES},
        "folder": _folder(),
        "path": list(sys.path),
        "signals": [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)],
        "temporary": tempfile.tempdir,
        "umask": umask,
    }


def _folder():
    with suppress(FileNotFoundError):
        return Path.cwd()
    return None


@contextmanager
def as_before_tests() -> Iterator[None]:
    """Have the environment, Python's path and the folder of the process's beginning for a while."""
    environment, paths = dict(os.environ), list(sys.path)
    folder = _folder() or ROOT  # a test may have removed the folder it stands in
    _set(ENVIRONMENT, PATHS, ROOT)
    try:
        yield
    finally:
        _set(environment, paths, folder)


def _set(environment, paths, folder):
    os.environ.clear()
    os.environ.update(environment)
    sys.path[:] = paths
    os.chdir(folder)
