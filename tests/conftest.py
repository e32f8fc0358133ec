"""Fixtures and plugins for every test."""

import gc
import os
import signal
import sys

import pytest
from hypothesis import HealthCheck, settings
from xdist.scheduler import LoadFileScheduling

from harness.suite.environment import use_one_thread

pytest_plugins = [
    "pytester",
    "tests.beginning",
    "tests.extras",
    "tests.lanes",
    "tests.recorded",
    "tests.reporting.browser",
]

settings.register_profile(
    "tests",
    database=None,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("tests")
"""Neither a busy machine nor chance fails a property."""

os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
"""Hundreds of tests start a process: each would compile the package again, half a second long."""

use_one_thread()

gc.disable()
gc.set_threshold(100_000, 20, 20)
"""The usual ones look at the objects of a test up to twenty times as often, for nothing."""


def pytest_collection_finish():
    """Let the collector leave out what libraries and tests are made of, which stays to the end."""
    gc.freeze()
    gc.enable()


def pytest_sessionfinish():
    """Let native libraries find all their objects freed, or they print which are not."""
    gc.unfreeze()


@pytest.fixture(autouse=True, scope="session")
def _signals_of_a_terminal():
    """Let commands be interrupted although the tests run in a background job.

    A shell starts background jobs with SIGINT ignored, which every command that a test starts
    would inherit and respect.
    """
    for number in (signal.SIGINT, signal.SIGHUP):
        if signal.getsignal(number) is signal.SIG_IGN:
            signal.signal(number, signal.default_int_handler)


@pytest.fixture(autouse=True, scope="session")
def _forked_servers():
    """Save commands in the process of a test the start of their fork servers."""
    from tests.commands import servers_are

    with servers_are("forked"):
        yield


def pytest_xdist_auto_num_workers() -> int:
    """One worker more than processors: tests wait for browsers, timeouts and live robots."""
    return (os.cpu_count() or 1) + 1


def pytest_xdist_make_scheduler(config, log):
    """Whole files to workers: what the tests of a file share is made once, not by each worker."""
    return LoadFileScheduling(config, log) if config.option.dist == "load" else None
