"""Objects that steps add and remove are judged from the moment they appear."""

import pytest

from tests.running import run_case

BOX = "name: box, box: {size: [0.03, 0.03, 0.03]}"


def result_of(folder, text):
    path = folder / "objects.scenario.yaml"
    path.write_text(f"scenario: objects\nrobot: open_manipulator_x\n{text}", encoding="utf-8")
    return run_case(path)


def test_an_added_object_has_its_start_where_it_appeared(tmp_path):
    result = result_of(
        tmp_path,
        f"""steps:
  - wait: 0.1 s
  - add_object: {{{BOX}, pose: {{xyz: [0.2, 0.1, 0.03]}}}}
  - wait: 0.3 s
expect:
  - displaced: {{object: box, at_least: 5 mm}}
  - on: {{object: box, support: ground_plane}}
  - eventually: {{lifted: {{object: box, above: 1 cm}}}}
""",
    )
    assert [each.status for each in result.verdicts] == ["passed", "passed", "failed"]
    assert result.verdicts[0].margin == pytest.approx(0.01, abs=1e-3), "it fell by 15 mm"


def test_a_removed_object_of_the_start_comes_back_elsewhere(tmp_path):
    result = result_of(
        tmp_path,
        f"""objects:
  - {{{BOX}, pose: {{xyz: [0.2, 0, 0.015]}}}}
steps:
  - remove_object: box
  - wait: 0.1 s
  - add_object: {{{BOX}, pose: {{xyz: [0.2, 0.1, 0.016]}}}}
  - wait: 0.2 s
expect:
  - on: {{object: box, support: ground_plane}}
""",
    )
    assert result.outcome == "passed", (result.problems, result.verdicts)


GHOST = "{name: ghost, box: {size: [0.02, 0.02, 0.02]}, in: planning, pose: {xyz: [0.2, 0, 0.2]}}"
ATTACHED = "'ghost' is attached: detach it first"


@pytest.mark.nightly(but=[0, 3, 4])
@pytest.mark.parametrize(
    ("steps", "message"),
    [
        (["attach_object: ghost", "release: ghost"], ""),
        (["release: ghost"], "'ghost' is not attached"),
        (["release: box"], "'box' is not attached"),
        (["attach_object: ghost", "remove_object: ghost"], ATTACHED),
        (["attach_object: box", "detach_object: box", "remove_object: box"], ""),
        (["attach_object: ghost", "attach_object: ghost"], "'ghost' is attached already"),
        (["attach_object: ghost", "clear_objects: {world: true}", "release: ghost"], ""),
        (["attach_object: {object: ghost, represents: box}", "remove_object: box"], ""),
        (
            ["attach_object: ghost", "move_object: {object: ghost, pose: {xyz: [0, 0.2, 0.1]}}"],
            ATTACHED,
        ),
    ],
)
def test_what_is_attached_or_not_is_released_or_refused(tmp_path, steps, message):
    """Objects of the planner alone have no weld in the physics that could end."""
    text = "".join(f"  - {step}\n" for step in steps)
    box = f"{{{BOX}, pose: {{xyz: [0.2, 0.1, 0.015]}}}}"
    result = result_of(tmp_path, f"objects: [{GHOST}, {box}]\nsteps:\n{text}")
    last = result.steps[-1]
    assert (last.status, last.message) == ("failed" if message else "passed", message)


@pytest.mark.parametrize(
    "other", ["size: [0.02, 0.02, 0.02]}, mass: 0.1", "size: [0.02, 0.02, 0.02]}"]
)
def test_another_object_of_the_same_name_is_refused(other, tmp_path):
    result = result_of(
        tmp_path,
        f"""objects:
  - {{{BOX}, pose: {{xyz: [0.2, 0, 0.015]}}}}
steps:
  - remove_object: box
  - add_object: {{name: box, box: {{{other}, pose: {{xyz: [0.2, 0.1, 0.016]}}}}
""",
    )
    assert result.outcome == "invalid"
    assert "a name stands for one object" in result.problems[0].hint
