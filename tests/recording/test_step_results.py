"""What steps report: typed parts while they run, and again when the run is read from its folder."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import harness.steps.pick
import harness.steps.release
from harness.core.details import Details
from harness.core.registry import registry
from harness.recording.digest import digest
from harness.recording.execution_failures import GripperOutcome
from harness.recording.read_run import read_run
from harness.recording.step_results import CELL_RESULTS, CartesianPathResult, SceneChange
from harness.recording.stored_run import StoredRun
from harness.recording.write_run import write_run
from tests.judging.synthetic_run import make_run, step

OUTCOME = GripperOutcome(0.01, 0.02, 3.0, True, False, {"left": ("box",), "right": ()})
RELEASED = harness.steps.release.Released("box")


def saved(folder: Path, **results):
    """The steps of a run that was written and read; each verb with what it reported."""
    steps = [
        replace(step(verb, 0, 1, verb), result=Details(parts)) for verb, parts in results.items()
    ]
    run = make_run(steps=steps)
    write_run(folder / "run", StoredRun(run, (), "passed", digest(run, ()), {}))
    return read_run(folder / "run").run.steps


def test_a_saved_run_gives_back_what_its_steps_reported(tmp_path):
    changed = SceneChange(added=("box", "lid"))
    release, add = saved(tmp_path, release=(OUTCOME, RELEASED), add_object=(changed,))
    assert release.result.find(GripperOutcome) == OUTCOME
    assert release.result.find(harness.steps.release.Released) == RELEASED
    assert add.result.find(SceneChange) == changed
    assert release.result.find(SceneChange) is None
    assert release.result.plain()["contacts"] == {"left": ["box"], "right": []}


def test_a_step_whose_package_is_missing_keeps_plain_data(tmp_path):
    (unknown,) = saved(tmp_path, weigh=(OUTCOME, CartesianPathResult(0.5, 0.1)))
    assert unknown.result.find(GripperOutcome) is None, "no class says that it is one"
    assert unknown.result.find(CartesianPathResult) == CartesianPathResult(0.5, 0.1)
    assert unknown.result.plain()["stalled"] is True


def test_another_step_s_part_and_a_value_of_another_type_are_no_result(tmp_path):
    half = harness.steps.pick.GraspChoice(4, 2)
    pick, place = saved(tmp_path, pick=(half,), place=(half,))
    assert pick.result.find(harness.steps.pick.GraspChoice) == half
    assert place.result.find(harness.steps.pick.GraspChoice) is None
    wrong = step("path", 0, 1, "cartesian_path", result={"fraction": "1", "largest_joint_step": 0})
    assert wrong.result.find(CartesianPathResult) is None


def test_no_two_parts_of_a_step_have_the_same_key():
    """Their fields share one mapping in run.json."""
    for verb, kind in registry("step").items():
        names = [name for part in (*CELL_RESULTS, *kind.results) for name in part.__annotations__]
        assert len(names) == len(set(names)), verb


def test_reading_a_saved_run_imports_no_step(tmp_path):
    saved(tmp_path, release=(RELEASED,))
    code = (
        "import sys; from pathlib import Path; from harness.recording.read_run import read_run;"
        f"read_run(Path({str(tmp_path / 'run')!r})).run.steps[0].result.plain();"
        "sys.exit('harness.steps' in sys.modules or 'pydantic' in sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
