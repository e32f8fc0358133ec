"""The scenarios that show each motion step pass as they stand."""

from pathlib import Path

import pytest

from harness.core.resources import data_folder
from harness.recording.read_run import read_run
from tests.running import run_case

MOTIONS = sorted((data_folder("scenarios") / "motions").glob("*.scenario.yaml"))


@pytest.mark.nightly(but=["02_sequence"])
@pytest.mark.parametrize("path", MOTIONS, ids=lambda path: path.name.split(".")[0])
def test_a_motion_scenario_passes(path, tmp_path):
    result = run_case(path, report_dir=tmp_path / "run", stills=False, page=False)
    reported = [step.message for step in result.steps if step.status == "failed"]
    assert result.outcome == "passed", (reported, result.message)
    record = read_run(tmp_path / "run").run
    moved = [step for step in record.steps if step.trajectory is not None]
    refused = [step for step in record.steps if step.error_code]
    assert moved
    assert all(step.start_index == step.end_index - 1 for step in refused)  # and nothing moved


def test_the_page_next_to_them_lists_all_of_them():
    reported = (MOTIONS[0].parent / "README.md").read_text()
    assert all(f"]({Path(path).name})" in reported for path in MOTIONS)
