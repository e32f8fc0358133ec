"""A run reports what it allowed without a request."""

import pytest

from harness.core.resources import data_folder
from harness.recording.read_run import read_run
from tests.running import run_case

PICK = data_folder("scenarios") / "lessons" / "04_ur_pick_by_friction.scenario.yaml"


@pytest.mark.nightly
def test_an_object_lifted_off_its_table_is_reported_with_its_distance(tmp_path):
    run_case(PICK, report_dir=tmp_path / "run", stills=False, page=False)
    run = read_run(tmp_path / "run").run
    lowered = [found for found in run.findings if found.kind == "lowered_margin"]
    reported = {(found.step, *found.values["pair"]): found for found in lowered}
    lift = reported["pick.lift", "green_cylinder", "Table_0"]
    assert abs(lift.values["start_distance"]) < 1e-3
    assert "green_cylinder and Table_0 stood" in lift.message
