"""Warnings of verdicts: notes of a run that passes, failures of a strict one."""

import json

import pytest

from tests.commands import harness

STILL = """\
scenario: Nothing moves
robot: {model: open_manipulator_x, base: {xyz: [0, 0, 0.01]}}
objects:
  - {name: cube, box: {size: [0.04, 0.04, 0.04]}, pose: {xyz: [0.3, 0.2, 0.0199]}}
steps: [{wait: 0.2 s}]
expect:
  - EXPECT
"""
WARNED = "eventually: {upright: cube}"
PLAIN = "always: {upright: cube}"


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(("expected", "code"), [(WARNED, 1), (PLAIN, 0)])
def test_a_warning_fails_a_strict_run_and_no_other(expected, code, tmp_path):
    (tmp_path / "still.scenario.yaml").write_text(STILL.replace("EXPECT", expected))
    loose = harness("run", "still.scenario.yaml", "--in-process", "--no-page", cwd=tmp_path)
    assert loose.returncode == 0
    strict = harness(
        "run", "still.scenario.yaml", "--strict", "--no-report", "--in-process", cwd=tmp_path
    )
    assert strict.returncode == code
    for done in (loose, strict):
        assert ("warning: already true at the start" in done.stdout) == bool(code)
    assert ("still.scenario.yaml --strict" in strict.stdout) == bool(code)
    [verdict] = json.loads((tmp_path / "reports/still/run.json").read_text())["verdicts"]
    assert [each["name"] for each in verdict["warnings"]] == (
        ["already true at the start"] if code else []
    )
    assert verdict["observed"]["samples"] == 201
    assert harness("judge", "reports/still", cwd=tmp_path).returncode == 0
    assert harness("judge", "reports/still", "--strict", cwd=tmp_path).returncode == code
