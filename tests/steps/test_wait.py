"""`wait`: where its timeout may stand."""

import jsonschema
import pytest
import yaml

from harness.plugins.authoring.scenario_schema import scenario_schema
from harness.session.check import check_file

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
