"""A run of the graded scenario, and recordings that a student might make of it."""

import pytest

from harness.recording.read_run import read_run
from tests.plugins.grading.recordings import SCENARIO, students_recording


@pytest.fixture(scope="session")
def folder(recorded_run):
    """The scenario's own run."""
    return recorded_run(SCENARIO) / "run"


@pytest.fixture(scope="session")
def stored(folder):
    return read_run(folder)


@pytest.fixture
def recording(stored):
    return students_recording(stored.run)


@pytest.fixture(scope="session")
def whole(stored, tmp_path_factory):
    return students_recording(stored.run).write(tmp_path_factory.mktemp("whole") / "whole.mcap")
