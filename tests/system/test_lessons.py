"""The lessons pass, and have the same digest in a row, side by side and alone."""

import json
from pathlib import Path

import numpy as np
import pytest

from harness.cli.main import main
from harness.core.resources import data_folder
from harness.recording.read_run import read_run
from tests.running import run_case

LESSONS = data_folder("scenarios") / "lessons"
FLAGSHIP = LESSONS / "03_ur_sixteen_steps.scenario.yaml"
FIRST = LESSONS / "01_open_manipulator_first_steps.scenario.yaml"
LAST = LESSONS / "04_gripper_alone.scenario.yaml"
SECOND = LESSONS / "02_open_manipulator_inverse_kinematics.scenario.yaml"


def run_json(capsys, *arguments):
    code = main(["run", *map(str, arguments), "--json", "--no-report"])
    document = json.loads(capsys.readouterr().out)
    return code, {Path(case["file"]).name: case for case in document["cases"]}


@pytest.fixture(scope="module")
def flagship(recorded_run):
    return read_run(recorded_run(FLAGSHIP) / "run")


@pytest.mark.nightly(but=["two"])
@pytest.mark.parametrize("files", [[FIRST, LAST], [LESSONS]], ids=["two", "all"])
def test_lessons_pass_side_by_side_with_the_digests_that_they_have_alone(flagship, capsys, files):
    code, cases = run_json(capsys, *files, "-j", "2")
    assert code == 0, {name: (case["outcome"], case["message"]) for name, case in cases.items()}
    assert len(cases) == (2 if FIRST in files else len(list(LESSONS.glob("*.scenario.yaml"))))
    alone = {LAST.name: run_case(LAST).digest, FLAGSHIP.name: flagship.digest}
    found = {name: cases[name]["digest"] for name in alone if name in cases}
    assert found
    assert found.items() <= alone.items()


@pytest.mark.nightly
def test_lessons_have_equal_digests_in_a_row_side_by_side_and_alone(capsys):
    _, in_a_row = run_json(capsys, LESSONS)
    _, side_by_side = run_json(capsys, FIRST, SECOND, "-j", "2")
    _, alone = run_json(capsys, FIRST)
    digests = {name: case["digest"] for name, case in in_a_row.items()}
    assert len(side_by_side) == 2
    assert digests.items() >= {(name, case["digest"]) for name, case in side_by_side.items()}
    assert alone[FIRST.name]["digest"] == digests[FIRST.name]


def test_the_flagship_keeps_every_promise_of_the_lesson(flagship):
    run = flagship.run
    assert len(flagship.verdicts) >= 25
    assert all(verdict.margin > 0 for verdict in flagship.verdicts if verdict.unit == "m")
    fingers = {record.id: record.result for record in run.steps}["step_12"].plain()
    assert fingers["stalled"]
    assert fingers["position"] == pytest.approx(0.576, abs=0.004)  # pads on the 60 mm cylinder


def test_what_the_steps_of_the_flagship_added_is_gone_at_the_end(flagship):
    run = flagship.run
    end = run.signals.times[-1]
    added = ("hanging_box", "upper_box", "cylinder", "low_box")
    there = {obj.name: obj.present[-1][1] for obj in run.objects}
    cleared = {record.id: record for record in run.steps}["cleared"]
    assert set(cleared.result.plain()["removed"]) == {"cylinder", "low_box"}
    assert all(there[name] <= end for name in added)
    assert not any(attachment.end_time > end for attachment in run.attachments)


@pytest.mark.nightly
def test_without_the_boxes_the_path_is_another(flagship, tmp_path):
    with_boxes = flagship.run
    text = FLAGSHIP.read_text()
    for frame in ("xyz: [0, -0.6, 0.5]", "xyz: [0.3, 0.3, 0.7]"):
        assert frame in text
        text = text.replace(frame, "xyz: [0, 0, 5]")
    path = tmp_path / "without.scenario.yaml"
    path.write_text(text)
    result = run_case(path, report_dir=tmp_path / "run", stills=False, page=False)
    assert not result.message
    without = read_run(tmp_path / "run").run

    def motion(run, step):
        return {record.id: record for record in run.steps}[step].trajectory.positions

    assert not all(
        np.array_equal(motion(with_boxes, step), motion(without, step))
        for step in ("step_3", "step_4")
    )


@pytest.mark.nightly
@pytest.mark.parametrize("model", ["ur3e", "ur5e"])
@pytest.mark.parametrize("seed", range(1, 21))
def test_the_flagship_passes_on_both_arms_for_twenty_seeds(model, seed):
    result = run_case(FLAGSHIP, overrides={"robot.model": model}, seed=seed, stills=False)
    assert result.outcome == "passed", [
        (verdict.expectation, verdict.reason)
        for verdict in result.verdicts
        if verdict.status != "passed"
    ] + [(step.id, step.message) for step in result.steps if step.message]
