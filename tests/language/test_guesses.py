"""A guess at what was intended is advice: what stands there is no value of the guessed key."""

import pytest

from harness.cli.main import main
from tests.language.test_mistakes import HEAD, problems

BOX = "{name: a, box: {size: [1, 1, 1]}, %s}"


def messages(text):
    return [(each.message, each.hint) for each in problems(text)]


@pytest.mark.parametrize(
    ("key", "word"),
    [
        ("suction: true", "`robot: {model: ur5e, gripper: suction_cup}`"),
    ],
)
def test_what_is_a_gripper_is_no_key_of_an_object(key, word):
    [(message, hint)] = messages(f"objects: [{BOX % key}]\n{HEAD}  - settle\n")
    assert message == f"unknown key `{key.partition(':')[0]}`"
    assert word in hint
    assert "did you mean" not in hint


@pytest.mark.parametrize("key", ["hinge: {axis: [0, 0, 1]}", "drawer: true"])
def test_doors_and_drawers_are_joints(key):
    found = messages(f"objects: [{BOX % key}]\n{HEAD}  - settle\n")
    assert "`joints`" in found[0][1]


@pytest.mark.parametrize(
    ("key", "word"),
    [
        ("conveyor: {speed: 0.1}", "`surface_velocity: 0.1`"),
        ("turntable: 1", "`surface_rotation`"),
        ("suction: true", "`robot: {model: ur5e, gripper: suction_cup}`"),
        ("vacuum: {cups: 2}", "`robot: {model: ur5e, gripper: suction_cup}`"),
        ("door: a", "`joints` of an object"),
    ],
)
def test_what_is_a_part_of_an_object_or_a_gripper_is_no_key_of_a_scenario(key, word):
    [(message, hint)] = messages(f"{key}\n{HEAD}  - settle\n")
    assert message == f"unknown key `{key.partition(':')[0]}`"
    assert word in hint
    assert "did you mean" not in hint


def test_several_robots_have_names():
    text = "scenario: x\nrobots: [ur3e, ur5e]\nsteps:\n  - settle\n"
    [(message, hint)] = messages(text)
    assert message == "`robots` is a mapping of keys and values, not a list"
    assert "`{NAME: ur3e, ...}`" in hint


@pytest.mark.parametrize(
    "text",
    [
        f"{HEAD}  - settle: {{timeout_max: [1, 2]}}\n",
        f"{HEAD}  - place: {{object: a, pose: {{xyz: [0, 0, 0], rotate: up}}}}\n",
        f"objects: [{BOX % 'frictions_of: 7 deg'}]\n{HEAD}  - settle\n",
        f"{HEAD}  - settle\nexpect:\n  - conveyor: 3\n",
        f"{HEAD}  - settle\nexpect:\n  - collision_free: true\n",
        f"{HEAD}  - settle\nexpect:\n  - no_contact: false\n",
        f"{HEAD}  - place: {{object: a, at: [0, 0, 1]}}\n",
        f"{HEAD}  - move_to: {{xyz: [0, 0, 1]}}\n",
        f"{HEAD}  - gripper: 0.01\n",
        f"{HEAD}  - move_to: [0, 0, 0]\n",
        f"{HEAD}  - assert: {{lifted: a}}\n",
        f"objects: [{BOX % 'joint: hinge'}]\n{HEAD}  - settle\n",
        f"{HEAD}  - attach_object: {{object: a, touch_link: hand}}\n",
        f"{HEAD}  - place: {{object: a, poses: up}}\n",
    ],
)
def test_a_guess_brings_no_second_problem(text):
    assert len(messages(text)) == 1


@pytest.mark.parametrize(
    ("text", "second"),
    [
        (f"{HEAD}  - place: {{object: a, poses: {{xyz: [0, 0]}}}}\n", "`xyz` has 2 items"),
        (f"{HEAD}  - place: {{object: a, pose: {{position: [0, 0, up]}}}}\n", "a length is"),
    ],
)
def test_mistakes_below_a_slip_of_the_pen_and_a_known_synonym_are_reported_too(text, second):
    assert [message for message, _ in messages(text)][1].startswith(second)


@pytest.mark.parametrize(
    ("step", "advice"),
    [
        ("gripper: 0.01", "write `{position: 0.01}` or `{width: 0.01}`"),
        ("place: {object: a, at: [0, 0, 1]}", "write `pose: {xyz: [0, 0, 1]}`"),
        ("ptp: {position: {at: [0, 0, 1]}}", "did you mean `xyz`?"),
        ("lin: {location: [0, 0, 1]}", "keys: named_target"),
        ("check: {lifted: a}", "below `expect:`"),
        ("placed: a", "below `expect:`"),
        ("spawn: a", "did you mean `add_object`?"),
        ("delete_object: a", "did you mean `remove_object`?"),
        ("allow_collisions: [a, b]", "keys: pairs, during"),
        ("move_relative: {direction: {xyz: 1}, distance: 1}", "write `[1, ...]`"),
    ],
)
def test_the_first_advice_can_be_followed(step, advice):
    assert advice in messages(f"{HEAD}  - {step}\n")[0][1]


@pytest.mark.parametrize(
    "step",
    [
        "allow_collisions: {pairs: [[a, b]], during: true}",
        "attach_object: {object: a, touch_links: false}",
        "lin: {pose: {xyz: true}}",
    ],
)
def test_true_and_false_are_not_written_as_the_items_of_a_list(step):
    [(message, hint)] = messages(f"{HEAD}  - {step}\n")
    assert "is a list, not `" in message
    assert hint == ""


@pytest.mark.parametrize(
    ("expected", "advice"),
    [
        ("collision_free: true", "write `never: collision`"),
        ("moved: a", "did you mean `displaced`?"),
        ("near: {object: a}", "did you mean `placed`?"),
        ("duration: {max: 3}", "did you mean `at_most`?"),
        ("lifted: {object: a, height: 1}", "did you mean `above`?"),
    ],
)
def test_what_other_programs_call_an_expectation_is_answered_with_its_word(expected, advice):
    assert advice in messages(f"{HEAD}  - settle\nexpect: [{{{expected}}}]\n")[0][1]


def test_the_title_of_a_file_is_its_key_scenario():
    assert messages("name: x\nrobot: ur3e\nsteps: [settle]\n")[0][1].startswith(
        "did you mean `scenario`?"
    )


@pytest.mark.parametrize(
    "cases",
    [
        "[{name: left, params.x: 1}, {name: right, params.x: 2}]",
        "[{title: left, params.x: 1}]",
        "{cases: [{id: left, params.x: 1}]}",
    ],
)
def test_the_name_of_a_case_is_its_id(tmp_path, cases, capsys):
    file = tmp_path / "named.scenario.yaml"
    file.write_text(f"{HEAD}  - wait: ${{x}}\nparams: {{x: 1}}\nparametrize: {cases}\n")
    assert main(["check", str(file)]) == 2
    said = " ".join("".join(capsys.readouterr()).replace("|", "").split())
    assert ":6:" in said
    assert "with its name as `id`: `- {id: small, params.size: 2 cm}`" in said


@pytest.mark.parametrize(
    ("robot", "extra"),
    [
        ("{model: ur3e, manipulators: [left]}", ""),
        ("{model: ur3e, kind_of: six_axes}", ""),
        ("ur3e", "setting: {arms: [left]}\n"),
        ("ur3e", "stuff: [{name: left}]\n"),
    ],
)
def test_the_use_of_a_name_below_an_unknown_key_is_no_second_problem(
    tmp_path, robot, extra, capsys
):
    file = tmp_path / "arms.scenario.yaml"
    steps = "steps:\n  - {move_to: up, robot: left}\n  - {move_to: home, robot: left}\n"
    file.write_text(f"scenario: x\nrobot: {robot}\n{extra}{steps}")
    assert main(["check", str(file)]) == 2
    printed = capsys.readouterr().out
    assert "unknown key" in printed
    assert printed.rstrip().endswith(": 1 problem")


def test_an_arm_that_no_unknown_key_names_is_reported_with_it(tmp_path, capsys):
    file = tmp_path / "arms.scenario.yaml"
    text = "scenario: x\nrobot: ur3e\nstuff: [a]\nsteps: [{move_to: up, robot: left}]\n"
    file.write_text(text)
    assert main(["check", str(file)]) == 2
    assert "the robot has one arm, and 'left' selects one" in capsys.readouterr().out


@pytest.mark.parametrize("motion", ["move_to", "ptp"])
def test_what_stands_one_column_too_far_in_counts_for_the_step(tmp_path, motion, capsys):
    """A step of an arm, and one with an `id` that an expectation names, have one problem each."""
    file = tmp_path / "arms.scenario.yaml"
    arms = "{left: {model: ur3e, base: {xyz: [0, 1, 0]}}, right: ur3e}"
    inside = f"{motion}: {{%s, joints: {{%s_elbow_joint: 1}}}}"
    one, other = inside % ("robot: right", "right"), inside % ("id: bend, robot: left", "left")
    expected = "expect: [{duration: {at_most: 9 s}, during: bend}]"
    steps = f"steps:\n  - parallel:\n    - {one}\n    - {other}\n"
    file.write_text(f"scenario: x\nrobots: {arms}\n{steps}{expected}\n")
    assert main(["check", str(file)]) == 2
    printed = capsys.readouterr().out
    assert "`robot` stands next to" in printed
    assert "`id` stands next to" in printed
    assert printed.rstrip().endswith(": 3 problems")
