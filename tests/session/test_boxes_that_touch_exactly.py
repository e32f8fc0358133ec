"""Bodies that stand where they touch exactly are in contact from the first sample on."""

import pytest

from harness.recording.read_run import read_run
from tests.running import run_case

BOX = "box: {size: [0.06, 0.06, 0.1]}, mass: 0.2"
SCENE = f"""scenario: boxes on boxes
robot: {{model: ur3e, base: {{xyz: [0, 0, 0.3]}}}}
objects:
  - {{name: lower, {BOX}, pose: {{xyz: [0.7, 0.7, 0.05]}}}}
  - {{name: upper, {BOX}, pose: {{xyz: [0.7, 0.7, 0.15]}}}}
  - {{name: moved, {BOX}, pose: {{xyz: [0.7, -0.7, 0.05]}}}}
  - {{name: dropped, {BOX}, pose: {{xyz: [-0.7, -0.7, 0.051]}}}}
steps:
  - wait: 0.1 s
  - move_object: {{object: moved, pose: {{xyz: [0.7, 0.7, 0.25]}}}}
  - add_object: {{name: added, {BOX}, pose: {{xyz: [0.7, 0.7, 0.35]}}}}
  - wait: 0.2 s
    id: last
expect:
"""
EXPECTED = {
    "always: {on: {object: upper, support: lower}}": "passed",
    "always: {in_contact: [upper, lower]}": "passed",
    "always: {in_contact: [lower, ground_plane]}": "passed",
    "{always: {on: {object: moved, support: upper}}, during: last}": "passed",
    "{always: {in_contact: {between: [moved, upper], min_force: 1}}, during: last}": "passed",
    "always: {on: {object: added, support: moved}}": "passed",
    "always: {in_contact: [added, moved]}": "passed",
    "always: {on: {object: dropped, support: ground_plane}}": "failed",
    "always: {in_contact: [dropped, ground_plane]}": "failed",
}


@pytest.fixture(scope="module")
def verdicts(tmp_path_factory):
    folder = tmp_path_factory.mktemp("boxes")
    path = folder / "a.scenario.yaml"
    path.write_text(SCENE + "".join(f"  - {each}\n" for each in EXPECTED), encoding="utf-8")
    run_case(path, report_dir=folder / "run", stills=False, page=False)
    return [each.status for each in read_run(folder / "run").verdicts]


@pytest.mark.parametrize("number", range(len(EXPECTED)), ids=[*EXPECTED])
def test_what_is_put_where_it_touches_is_in_contact_at_once(verdicts, number):
    assert verdicts[number] == [*EXPECTED.values()][number]
