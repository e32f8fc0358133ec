"""What a scenario file allows and probably does not intend: check, run and report all say it."""

import json

import pytest

import harness
from harness.cli.main import main
from harness.session.observation.findings import NOTHING_EXPECTED

HEAD = "scenario: Notes\nrobot: open_manipulator_x\nsteps:\n"
SILENT = {
    "expect": "  - wait: 0.05 s\nexpect: [within_limits]\n",
    "expect of a step": "  - {wait: 0.05 s, expect: [within_limits]}\n",
    "expected error": "  - {move_to: {joints: {joint1: 4}}, expect_error: GOAL_STATE_INVALID}\n",
}


def written(folder, text):
    path = folder / "notes.scenario.yaml"
    path.write_text(HEAD + text)
    return path


@pytest.mark.nightly
def test_a_scenario_that_expects_nothing_passes_and_everything_says_so(tmp_path, capsys):
    path = written(tmp_path, "  - wait: 0.05 s\n")
    assert main(["check", str(path)]) == 0
    assert f"note: {NOTHING_EXPECTED}" in capsys.readouterr().out
    assert main(["run", str(path), "--report-dir", str(tmp_path / "r")]) == 0
    printed = capsys.readouterr().out
    assert f"note: {NOTHING_EXPECTED}" in printed
    assert "expects nothing" in printed
    assert "0 of 0" not in printed
    report = next((tmp_path / "r").rglob("run.json")).parent
    found = json.loads((report / "run.json").read_text())["findings"]
    assert [each["message"] for each in found if each["kind"] == "nothing_expected"] == [
        NOTHING_EXPECTED
    ]
    page = (report / "report.html").read_text()
    assert "the scenario expects nothing" in page
    assert "none is stated" in page


@pytest.mark.nightly(but=["expect of a step"])
@pytest.mark.parametrize("text", SILENT.values(), ids=SILENT)
def test_a_scenario_that_expects_something_has_no_such_note(tmp_path, text):
    path = written(tmp_path, text)
    result = harness.run(path, report_dir=tmp_path / "r")
    assert result.passed
    assert "nothing_expected" not in {finding.kind for finding in result.run.findings}
    assert not any("expects nothing" in note for note in result.case.notes)


@pytest.mark.parametrize(
    ("expected", "said"),
    [
        ("path_length: {at_most: 1000 m}", "`at_most` is 1000 m"),
        ("duration: 100000 s", "`at_most` is 100000 s"),
        ("{eventually: {gripper: open}, within: 3000 s}", "`within` is 3000 s"),
        ("never: {in_contact: {between: [robot, any], min_force: 1e6}}", "`min_force` is 1e+06 N"),
        ("path_length: {at_most: 20 m}", ""),
        ("duration: 600 s", ""),
    ],
)
def test_a_limit_that_no_run_reaches_is_noted(tmp_path, capsys, expected, said):
    path = written(tmp_path, f"  - wait: 0.05 s\nexpect:\n  - {expected}\n")
    assert main(["check", str(path)]) == 0
    printed = capsys.readouterr().out
    assert ("more than any run reaches" in printed) == bool(said), printed
    assert not said or f"note: line 6: {said}, more than any run reaches" in printed


@pytest.mark.parametrize(
    ("expected", "said"),
    [
        ("path_length: 500", "500 is a length in metres; write `500 mm` for millimetres"),
        ("always: {path_length: {at_most: 20}}", "20 is a length in metres; write `20 mm`"),
        ("duration: 300", "300 is a time in seconds; write `300 ms` for milliseconds"),
        ("{eventually: {gripper: open}, within: 250}", "250 is a time in seconds; write `250 ms`"),
        ("path_length: 500 m", ""),
        ("path_length: 8", ""),
        ("duration: 60", ""),
    ],
)
def test_a_limit_without_a_unit_that_looks_like_another_one_is_noted(
    tmp_path, capsys, expected, said
):
    path = written(tmp_path, f"  - wait: 0.05 s\nexpect:\n  - {expected}\n")
    assert main(["check", str(path)]) == 0
    printed = capsys.readouterr().out
    assert said in printed
    assert ("; write" in printed) == bool(said), printed


def test_an_angle_that_looks_like_degrees_is_noted_with_its_place(tmp_path, capsys):
    text = "  - wait: 0.05 s\nobjects:\n  - {name: a, box: {size: [0.1, 0.1, 0.1]}, static: true,"
    text += " pose: {xyz: [0.5, 0, 0.5], rpy: [0, 0, 90]}}\nexpect: [within_limits]\n"
    path = written(tmp_path, text)
    assert main(["check", str(path)]) == 0
    said = "6:98: 90 is an angle in radians, 5156.6 degrees; write `90 deg` for degrees"
    assert said in capsys.readouterr().out
    result = harness.run(path)
    assert any(said in note for note in result.case.notes)
    assert any(said in finding.message for finding in result.run.findings)


def test_a_pose_in_millimetres_is_out_of_reach_with_a_hint(tmp_path, capsys):
    path = written(tmp_path, "  - move_to: {position: [400, 0, 90]}\nexpect: [within_limits]\n")
    assert main(["check", str(path)]) == 1
    said = capsys.readouterr().out
    assert "4:26: 400 is a length in metres; write `400 mm` for millimetres" in said
    assert "90 is a length" not in said


def test_a_joint_goal_in_degrees_is_out_of_reach_with_a_hint(tmp_path, capsys):
    path = written(tmp_path, "  - move_to: {joints: {joint1: 90}}\nexpect: [within_limits]\n")
    assert main(["check", str(path)]) == 1
    assert "4:32: 90 is an angle in radians" in capsys.readouterr().out


def test_a_movable_box_of_fifty_metres_gets_a_hint_to_millimetres(tmp_path, capsys):
    box = "objects:\n  - {{name: a, box: {{size: {}}}, pose: {{xyz: [60, 0, 60]}}}}\n"
    text = "  - wait: 0.05 s\n{}expect: [within_limits]\n"
    path = written(tmp_path, text.format(box.format("[50, 50, 50]")))
    assert main(["check", str(path)]) == 0
    said = "'a' measures 50 m: a number without a unit is in metres, write `50 mm` for millimetres"
    assert said in capsys.readouterr().out
    path = written(tmp_path, text.format(box.format("[50 mm, 50 mm, 50 mm]")))
    assert main(["check", str(path)]) == 0
    assert "measures" not in capsys.readouterr().out
