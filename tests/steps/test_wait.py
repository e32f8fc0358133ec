"""`wait`: where its timeout may stand."""

import jsonschema
import pytest
import yaml

from harness.plugins.authoring.scenario_schema import scenario_schema
from harness.recording.read_run import read_run
from harness.session.check import check_file
from tests.running import run_case

UNTIL = "until: {joints: {positions: {joint1: 1.0}}}"
HEAD = "scenario: a test\nrobot: open_manipulator_x\nsteps:\n"


def found(folder, steps):
    path = folder / "a.scenario.yaml"
    path.write_text(HEAD + steps, encoding="utf-8")
    problems = [(each.line, each.message) for each in check_file(path).problems]
    is_valid = jsonschema.Draft7Validator(scenario_schema()).is_valid(
        yaml.safe_load(path.read_text())
    )
    return problems, is_valid


@pytest.mark.nightly(but=[0, 3])
@pytest.mark.parametrize(
    "step",
    [
        f"  - wait: {{{UNTIL}, timeout: 5 s}}\n",
        f"  - wait: {{{UNTIL}}}\n    timeout: 5 s\n",
        f"  - external: {{{UNTIL}, timeout: 5 s}}\n",
        f"  - external: {{{UNTIL}}}\n    timeout: 5 s\n",
    ],
)
def test_the_timeout_may_stand_inside_or_next_to_the_verb(step, tmp_path):
    assert found(tmp_path, step) == ([], True)


def test_a_timeout_in_both_places(tmp_path):
    step = f"  - wait: {{{UNTIL}, timeout: 5 s}}\n    timeout: 6 s\n"
    assert found(tmp_path, step)[0] == [(5, "`timeout` is here twice")]


def test_a_timeout_of_another_step_stands_next_to_it(tmp_path):
    step = "  - move_to: {joints: {joint1: 0.1}, timeout: 5 s}\n"
    problems, is_valid = found(tmp_path, step)
    assert problems == [(4, "`timeout` stands next to `move_to`, not inside it")]
    assert not is_valid


@pytest.mark.parametrize("timeout", ["0 s", "-1", "5 m"])
def test_a_timeout_inside_is_a_duration(timeout, tmp_path):
    problems, _ = found(tmp_path, f"  - wait: {{{UNTIL}, timeout: {timeout}}}\n")
    assert [line for line, _ in problems] == [4]


def test_what_holds_at_once_is_a_finding(tmp_path):
    path = tmp_path / "a.scenario.yaml"
    ball = "{name: ball, sphere: {radius: 2 cm}, mass: 0.1, pose: {xyz: [0.3, 0, 0.3]}}"
    rests = "{until: {formula: eventually z(ball) < 0.1 m}}"
    now = "{until: {joints: {positions: {joint1: 0}}}}"
    steps = f"- wait: {now}\n- wait: {rests}\n- wait: {rests}\n- wait: 0.1 s\n"
    path.write_text(f"{HEAD}{steps}objects: [{ball}]\n", encoding="utf-8")
    run_case(path, report_dir=tmp_path / "run", stills=False, page=False)
    found = [each for each in read_run(tmp_path / "run").run.findings if "held" in each.kind]
    assert [(each.kind, each.step) for each in found] == [
        ("held_at_once", "steps[0]"),
        ("held_at_once", "steps[2]"),
    ]
    assert found[0].message == "`wait until joints` held at once, so that nothing was waited for"
