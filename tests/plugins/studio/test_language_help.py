"""Completion and descriptions, from the schema and the names of a cell."""

import pytest

from harness.plugins.studio.language_help import complete, hover, path_at

NAMES = {
    "named_target": ["home", "up"],
    "gripper_target": ["open"],
    "object": ["box"],
    "joints": ["elbow_joint"],
    "link": ["tool0"],
    "gripper": ["hand_e"],
}
TEXT = """\
scenario: x
robot: {model: ur3e, }
steps:
  - move_to: |
    expect:
      - grasped:
          object: |
  - move_to:
      joints: {|: 1}
    planning:
      |
expect:
  - |
|
"""


def places():
    lines = TEXT.split("\n")
    return [
        ("\n".join(each.replace("|", "") for each in lines), number, line.index("|"))
        for number, line in enumerate(lines)
        if "|" in line
    ]


@pytest.mark.parametrize(
    ("place", "offered", "missing"),
    [
        (0, {"home", "up"}, {"box", "scenario", "joints"}),
        (1, {"box"}, {"home", "joints"}),
        (2, {"elbow_joint"}, {"home"}),
        (3, {"planner_id", "max_velocity_scaling_factor"}, {"move_to"}),
        (4, {"grasped", "always", "never"}, {"move_to", "robot"}),
        (5, {"world", "objects", "seed"}, {"move_to", "grasped"}),
    ],
)
def test_what_is_offered_at_a_place(place, offered, missing):
    found = {option.text for option in complete(*places()[place], NAMES)}
    assert offered <= found
    assert not missing & found


def test_keys_have_their_descriptions():
    text = "scenario: x\nsteps:\n  - lin: {}\n"
    options = {option.text: option for option in complete(text, 2, 4, NAMES)}
    assert options["lin"].kind == "key"
    assert "straight line" in options["lin"].help
    assert "straight line" in hover(text, 2, 5)
    assert hover(text, 0, 1) == "The title of the scenario."
    assert hover(text, 0, 11) == ""
    assert hover(text, 9, 0) == ""


def test_the_path_inside_brackets_on_one_line():
    text = "steps:\n  - move_to: {pose: {frame: base, xyz: [0, 1, "
    path, is_value = path_at(text, 1, len(text.split("\n")[1]))
    assert path == ("steps", "-", "move_to", "pose", "xyz", "-")
    assert is_value


@pytest.mark.parametrize(
    ("text", "offered"),
    [
        ("steps:\n- gripper: |", {"open"}),
        ("robot: {gripper: |", {"hand_e"}),
        ("steps:\n- pick: {\n    object: |", {"box"}),
        ("steps: [\n  {pick: |", {"box"}),
        ("steps: []\nexpect:\n- always: {grasped: |", {"box"}),
        ("# a comment |", set()),
        ("scenario: {x: }}\nsteps:\n- pick: |", {"box"}),
        ("steps:\n- pick: }|", set()),
    ],
)
def test_names_are_offered_in_any_style_of_yaml(text, offered):
    line = text.count("\n")
    column = text.split("\n")[-1].index("|")
    found = {option.text for option in complete(text.replace("|", ""), line, column, NAMES)}
    assert offered <= found
    assert bool(offered) == bool(found)


@pytest.mark.parametrize(
    "text",
    [
        "scenar\u2028(io: x\nrobot: ur3e\nst",
        "scenario: x\x85[: y\nrobot: ur3e\n",
        "a\u2029b\u2029c: {\nrobot: ur3e\nst",
        "a: 1\rb: (\r: c\n]\n",
        "- [\n- [\n- [\n- [\n",
    ],
)
def test_help_ends_whatever_breaks_the_lines(text):
    """Characters that are line breaks for YAML alone, and lines that stay wrong without others."""
    for line, content in enumerate(text.split("\n")):
        assert isinstance(complete(text, line, len(content), NAMES), list)
        assert isinstance(hover(text, line, 0), str)


def test_keys_are_offered_after_a_line_with_other_breaks():
    text = "scenario: x\u2028y\nrobot: ur3e\nst"
    assert "steps" in [option.text for option in complete(text, 2, 2, NAMES)]
