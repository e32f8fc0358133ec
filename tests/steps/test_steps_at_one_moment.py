"""Steps that take no time, one after the other: each is judged by what it did itself."""

import pytest

from tests.running import run_case

SCENARIO = """
scenario: two blocks are raised
robot: {gripper: rh_p12_rn_a, base: {xyz: [0, 0, 0.5]}}
objects:
  - {name: a, static: true, box: {size: [0.1, 0.1, 0.1]}, pose: {xyz: [0.3, 0.2, 0.05]}}
  - {name: b, static: true, box: {size: [0.1, 0.1, 0.1]}, pose: {xyz: [0.3, -0.2, 0.05]}}
steps:
  - wait: 20 ms
  - move_object: {object: a, pose: {xyz: [0.3, 0.2, 0.3]}}
    id: a_up
    expect: [{formula: "always z(NAME) > 0.25"}]
  - WAIT
  - move_object: {object: b, pose: {xyz: [0.3, -0.2, 0.3]}}
    id: b_up
    expect: [{formula: "always z(a) > 0.25 and z(b) > 0.25"}]
  - wait: 20 ms
"""


@pytest.mark.parametrize(
    ("name", "between", "status"),
    [
        ("b", "", "not observable"),
        ("a", "", "passed"),
        ("b", "  - wait: 10 ms\n", "failed"),
        ("a", "  - wait: 10 ms\n", "passed"),
    ],
)
def test_the_next_step_decides_no_verdict_of_a_step(tmp_path, name, between, status):
    file = tmp_path / "raise.scenario.yaml"
    file.write_text(SCENARIO.replace("  - WAIT\n", between).replace("NAME", name))
    first, second = run_case(file).verdicts
    assert first.status == status
    assert second.status == "passed"
    if status == "not observable":
        assert first.reason.startswith("step 'b_up' changed 'b' at the same moment")
