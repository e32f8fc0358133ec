"""Runs that many tests look at: made once, whichever worker needs one first, and never changed."""

import fcntl
import hashlib
import os
from pathlib import Path

import pytest

from harness.recording.read_run import read_run


@pytest.fixture(scope="session")
def recorded_run(tmp_path_factory):
    """`recorded_run(file, **options)`: the folder of the file's run with options of `run_case`.

    The folder holds the run in `run`, without page and pictures unless `page` and `stills` say so;
    `file` may be a scenario's text, too. It runs in a process of its own, so that it is the same
    whichever test needs it first. Tests that change a run change a copy.
    """
    base = tmp_path_factory.getbasetemp()
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base

    def record(file: Path | str, outcome: str = "passed", **options) -> Path:
        from tests.commands import forked, run

        said = f"{file}\0{sorted(options.items())}"
        folder = shared / "recorded" / hashlib.sha256(said.encode()).hexdigest()[:12]
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / "lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not (folder / "whole").exists():
                if isinstance(file, str):
                    (folder / "a.scenario.yaml").write_text(file, encoding="utf-8")
                    file = folder / "a.scenario.yaml"
                options = {"stills": False, "page": False} | options
                end = forked(run, file, options | {"report_dir": folder / "run"})
                assert end.code == 0, end.traceback or end.log
                (folder / "whole").touch()
        assert read_run(folder / "run").outcome == outcome
        return folder

    return record
