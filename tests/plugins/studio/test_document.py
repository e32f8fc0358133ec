"""The scenario as text: what is added stands where it belongs, and nothing else changes."""

from dataclasses import replace

import pytest

from harness.core.errors import SpecError
from harness.language.scenario import RobotSpec
from harness.plugins.studio.document import Document, flow, new_text
from harness.plugins.studio.texts import gripper_steps
from harness.robot.load import load_robot

TEXT = """\
# a comment at the top
scenario: "x"   # and one here
robot: ur3e
steps:
    - move_to: up
      expect:
        - named_target: up
    # before the last
    - {wait: 1 s}

# at the end
expect:
  - never: collision
"""


def test_a_step_is_added_between_others_with_their_indentation():
    lines = Document(TEXT).with_step("ptp: {named_target: home}", 1).text.splitlines()
    assert lines[4:10] == [
        "    - move_to: up",
        "      expect:",
        "        - named_target: up",
        "    # before the last",
        "    - ptp: {named_target: home}",
        "    - {wait: 1 s}",
    ]
    assert lines[:4] == TEXT.splitlines()[:4]


def test_a_step_is_added_at_the_end_before_what_follows():
    text = Document(TEXT).with_step("gripper: open\nid: opened", 2).text
    assert text == TEXT.replace(
        "    - {wait: 1 s}\n", "    - {wait: 1 s}\n    - gripper: open\n      id: opened\n"
    )


def test_the_first_step_and_the_first_object_of_a_new_scenario():
    document = Document(new_text("by hand", {"model": "ur3e", "gripper": "rh_p12_rn_a"}, "empty"))
    assert document.step_count == 0
    assert "wait" in document.compiled_text()
    changed = document.with_step("wait: 1 s", 0).with_object({"name": "a", "sphere": {"radius": 1}})
    assert changed.text.splitlines()[-4:] == [
        "objects:",
        "  - {name: a, sphere: {radius: 1}}",
        "steps:",
        "  - wait: 1 s",
    ]
    assert changed.without_step(0).without_object("a").text == document.text


def test_an_object_is_replaced_and_others_stay():
    text = "scenario: x\nobjects:\n- name: a\n  mass: 1\n- name: b\n  mass: 2\nsteps: []\n"
    changed = Document(text).with_object({"name": "a", "mass": 3})
    assert changed.object_names() == ["b", "a"]
    assert changed.object_spec("a") == {"name": "a", "mass": 3}
    assert changed.object_spec("b") == {"name": "b", "mass": 2}


def test_expectations_are_added_at_a_step_and_at_the_end():
    document = Document(TEXT)
    assert "        - named_target: up\n        - grasped: a\n" in (
        document.with_expectations(["grasped: a"], 0).text
    )
    assert document.with_expectations(["always: within_limits"], -1).text.endswith(
        "  - never: collision\n  - always: within_limits\n"
    )
    with pytest.raises(SpecError, match="several lines"):
        document.with_expectations(["grasped: a"], 1)


def test_the_step_of_a_line():
    document = Document(TEXT)
    assert [document.step_at(line) for line in (1, 5, 7, 9, 13)] == [-1, 0, 0, 1, 1]


def test_expectations_do_not_change_what_is_executed():
    document = Document(TEXT)
    keys = document.step_keys()
    assert document.with_expectations(["grasped: a"], 0).step_keys() == keys
    assert Document(TEXT.replace("1 s", "2 s")).step_keys()[0] == keys[0]
    assert Document(TEXT.replace("1 s", "2 s")).step_keys()[1] != keys[1]


def test_a_gripper_without_named_states_opens_and_closes_by_its_width():
    description = load_robot(RobotSpec(model="open_manipulator_x"))
    assert gripper_steps(description) == {"open": "gripper: open", "close": "gripper: close"}
    nameless = replace(description, named_states=())
    assert gripper_steps(nameless) == {
        "open": "gripper: {width: 0.08}",
        "close": "gripper: {width: 0.022}",
    }


def test_suction_cups_are_switched_by_the_keys_and_by_their_states():
    assert gripper_steps(load_robot(RobotSpec(model="suction_cup"))) == {
        "open": "gripper: {position: 0}",
        "close": "gripper: {position: 0.005}",
        "off": "gripper: off",
        "on": "gripper: on",
    }


def test_numbers_are_written_as_a_person_would():
    written = flow({"xyz": [0.1 + 0.2, -0.0, 2.0], "name": "on"})
    assert written == "{xyz: [0.3, 0, 2], name: 'on'}"
