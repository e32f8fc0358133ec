from pathlib import Path

import pytest

from harness.core.errors import SpecError
from harness.language.reading.load import load_scenario, parse_scenario

FILES = Path(__file__).parent / "files"
HEAD = "scenario: x\nrobot: ur3e\nsteps:\n"


def problems(text):
    with pytest.raises(SpecError) as caught:
        parse_scenario(text, Path("f.yaml"))
    return caught.value.problems


def test_ten_mistakes_give_ten_located_problems_at_once():
    with pytest.raises(SpecError) as caught:
        load_scenario(FILES / "ten_mistakes.yaml")
    found = [(p.line, p.column, p.message) for p in caught.value.problems]
    assert found == [
        (2, 22, "unknown key `griper`"),
        (3, 7, "`seed` must be at least 0, not `-1`"),
        (4, 46, "there is no planning pipeline `omlp`"),
        (6, 5, "no verb is called `move_too`"),
        (8, 5, "a step has one verb; this one has `gripper` and `move_to`"),
        (9, 11, "`120 milimeter`: no unit is called `milimeter`"),
        (10, 33, "`expect` stands next to `move_to`, not inside it"),
        (11, 23, "`xyz` has 2 items; item 3 is missing"),
        (12, 5, "`object` is missing in `pick`"),
        (14, 13, "no predicate is called `colision`"),
    ]


def test_a_problem_shows_the_line_a_caret_and_the_nearest_word():
    text = HEAD + "  - grsp: {object: box}\n"
    (problem,) = problems(text)
    first, excerpt, caret, *rest = str(problem).splitlines()
    assert first == "f.yaml:4:5: no verb is called `grsp`"
    assert excerpt == "    4 |   - grsp: {object: box}"
    assert caret == "      |     ^^^^"
    assert rest[0].startswith("      | did you mean `grasp`? verbs: add_object, allow_")


@pytest.mark.parametrize(
    ("step", "message", "hint"),
    [
        ("- §5", "a step is a verb with its content, not `5`", "verbs: add_object"),
        ("- §moveto: up", "no verb is called `moveto`", "did you mean `move_to`?"),
        ("- §xyzzy", "no verb is called `xyzzy`", "verbs: add_object"),
        ("- §{id: a}", "a step has one verb; this one has none", "verbs: add_object"),
        ("- {§do: lin}", "`do:` is not written", "verbs"),
        ("- {lin: up, §pose: {}}", "`pose` stands inside `lin`, not next to", "further right"),
        ("- {lin: up, §expct: []}", "unknown key `expct` next to `lin`", "mean `expect`?"),
        ("- clear_objects: §up", "`clear_objects` takes a mapping, not `up`", "keys: world"),
        ("- §move_to:", "exactly one of", "found none"),
        ("- §move_to: {named_target: a, joints: {b: 1}}", "exactly one of", "and `joints`"),
        ("- grasp: {object: §5}", "`object` is text, not `5`", 'write "5"'),
        ("- grasp: {object: a, mode: §glue}", "`mode` cannot be `glue`", "friction, weld"),
        ("- repeat: {times: §2.5, steps: [settle]}", "`times` is a whole number, not `2.5`", ""),
        ("- repeat: {times: 2, steps: §{}}", "`steps` is a list, not a mapping", ""),
        ("- repeat: {times: 2, steps: §[]}", "`steps` has at least 1 item, not 0", ""),
        ("- repeat: {times: 2, steps: [§grsp: a]}", "no verb is called `grsp`", "`grasp`?"),
        ("- {lin: up, expect_error: §COLLISION}", "cannot be `COLLISION`", "GOAL_IN_COLLISION"),
        ("- {lin: up, expect: §{grasped: a}}", "`expect` is a list, not a mapping", ""),
        ("- move_to: {joints: {a: §5 s}}", "`5 s` is a time; an angle or a length", "deg"),
        ("- move_to: {joints: {§'': 5}}", "a name has at least 1 character", ""),
        ("- move_to: {pose: {xyz: §5}}", "`xyz` is a list, not `5`", ""),
        ("- move_to: {pose: {xyz: §[0, 0, 0, 1]}}", "`xyz` has at most 3 items, not 4", ""),
        ("- move_to: {position: [0, 0, §up]}", "a length is a number, not `up`", "cm"),
        ("- move_to: {joints: §[0, -1.57]}", "`joints` is a mapping", "`{NAME: 0, ...}`"),
        ("- move_to: {pose: {xyz: [0, 0, 1]}, §rpy: [0, 0, 0]}", "`rpy`", "`pose: {rpy: ...}`"),
        (
            "- move_relative: {direction: {xyz: [0, 0, 1]}, distance: 1, §objects: []}",
            "`objects`",
            "column 1",
        ),
        (
            "- move_to: {pose: {quat_xyzw: §[1, 1, 0, 0]}}",
            "a quaternion has norm 1, this one 1.414",
            "normalised it is [0.707107, 0.707107, 0, 0]",
        ),
        (
            "- move_to: {pose: §{rpy: [0, 0, 0], quat_wxyz: [1, 0, 0, 0]}}",
            "a pose has one rotation",
            "rpy and quat_wxyz",
        ),
        ("- add_object: §{name: a}", "an object is exactly one of box", "or several"),
        ("- add_object: {name: a, box: {size: [1, 1, §0]}}", "`size` must be more than 0", ""),
        (
            "- add_object: {name: a, sphere: {radius: 1}, friction: §slick}",
            "`friction` is a number, not `slick`",
            "",
        ),
        (
            "- attach_object: {object: {§nme: a, sphere: {radius: 1}}}",
            "unknown key `nme`",
            "did you mean `name`?",
        ),
    ],
)
def test_a_mistake_in_a_step_is_one_problem_at_its_place(step, message, hint):
    (problem,) = problems(f"{HEAD}  {step.replace('§', '')}\n")
    assert (problem.line, problem.column) == (4, step.index("§") + 3)
    assert message in problem.message
    assert hint in f"{problem.message} {problem.hint}"


@pytest.mark.parametrize(
    ("expectation", "message", "hint"),
    [
        ("- §lifed: a", "no predicate is called `lifed`", "did you mean `lifted`?"),
        ("- {lifted: a, §grasped: a}", "one predicate; this one has `lifted`", "`- grasped:`"),
        ("- always: {lifted: a, §grasped: a}", "`always` has one predicate", "`- grasped:`"),
        ("- always: {§never: {lifted: a}}", "`never` cannot stand inside a temporal word", ""),
        ("- always: §withn_limits", "no predicate is called `withn_limits`", "`within_limits`"),
        ("- §{until: {lifted: a}}", "an expectation has one predicate", "always: A, until: B"),
        ("- {never: {lifted: a}, §until: {lifted: b}}", "`until` goes with `always`", "B does"),
        ("- §{name: b}", "an expectation has one predicate; this one has none", "lifted"),
        ("- lifted: {§objet: a}", "unknown key `objet` in `lifted`", "did you mean `object`?"),
        ("- {lifted: {object: a, for: 1}, §for: 2}", "`for` is here twice", "line 6"),
        ("- never: {lifted: {object: a, above: §5 kg}}", "`5 kg` is a mass; a length", "cm"),
        ("- §lifted:", "`object` is missing in `lifted`", "add `object:`"),
        ("- {lifted: a, for: §-1}", "`for` must be at least 0, not `-1`", ""),
        ("- {formula: time > 1, §for: 1}", "`for` has no meaning next to `formula`", ""),
        ("- collision: {between: §[robot]}", "`between` has 1 item; item 2 is missing", ""),
    ],
)
def test_a_mistake_in_an_expectation_is_one_problem_at_its_place(expectation, message, hint):
    (problem,) = problems(f"{HEAD}- settle\nexpect:\n{expectation.replace('§', '')}\n")
    assert (problem.line, problem.column) == (6, expectation.index("§") + 1)
    assert message in problem.message
    assert hint in problem.hint


def test_a_misspelt_word_is_read_as_the_nearest_so_that_its_content_is_checked():
    found = problems(HEAD + "- grsp: {object: 5, moode: weld}\n")
    assert [problem.message for problem in found] == [
        "no verb is called `grsp`",
        "`object` is text, not `5`",
        "unknown key `moode` in `grasp`",
    ]


def test_what_is_missing_at_the_top_is_at_the_files_start():
    found = problems("description: nothing else\n")
    assert [(p.line, p.column, p.message) for p in found] == [
        (1, 1, "`scenario` is missing"),
        (1, 1, "`steps` is missing"),
        (1, 1, "`robot` is missing"),
    ]


@pytest.mark.parametrize(
    ("content", "column_of", "message", "hint"),
    [
        ("place: {pose: [0.2, 0, 0.1]}", "[0.2", "`pose` is a mapping", "`{xyz: [0.2, 0, 0.1]}`"),
        ("pick: {object: a, lift: 5 cm}", "5 cm", "`lift` is a mapping", "`{distance: 5 cm}`"),
        ("pick: {object: a, lift: high}", "high", "`lift` is a mapping", "keys: direction"),
        ("move_to: {pose: {xyz: 0.2 0 0.1}}", "0.2 0", "`xyz` is a list", "`[0.2, 0, 0.1]`"),
        ('move_to: {pose: {xyz: "0.2, 0, 1"}}', '"0.2', "`xyz` is a list", "`[0.2, 0, 1]`"),
        ("move_to: {pose: {xyz: {x: 1, y: 0, z: 2}}}", "{x:", "`xyz` is a list", "`[1, 0, 2]`"),
        ("cartesian_path: {waypoints: {xyz: [0, 0, 1]}}", "{xyz", "is a list", "item with `- `"),
        ("move_to: {pose: {xyz: [0,2, 0,1, 0,3]}}", "[0,2", "at most 3 items", "has a point"),
    ],
)
def test_a_value_of_the_wrong_shape_is_written_out_in_the_right_one(
    content, column_of, message, hint
):
    (problem,) = problems(f"{HEAD}  - {content}\n")
    assert message in problem.message
    assert hint in problem.hint
    assert problem.column == 5 + content.index(column_of)


@pytest.mark.parametrize(
    ("content", "keyword"),
    [
        ("set_named_target: up", "move_to"),
        ("sleep: 1 s", "wait"),
        ("move_to: {pose: {translation: [0, 0, 1]}}", "xyz"),
        ("move_to: {pose: {orientation: [0, 0, 0, 1]}}", "quat_xyzw"),
        ("add_object: {name: a, sphere: {radius: 1 cm}, weight: 5 g}", "mass"),
        ("add_object: {name: a, box: {dimensions: [1 cm, 1 cm, 1 cm]}}", "size"),
    ],
)
def test_a_word_of_another_program_is_answered_with_the_word_of_this_one(content, keyword):
    (problem,) = problems(f"{HEAD}  - {content}\n")
    assert problem.hint.startswith(f"did you mean `{keyword}`? ")


@pytest.mark.parametrize(
    ("given", "advised"),
    [
        ("[0.2, 0, 0.1]", "{xyz: [0.2, 0, 0.1]}"),
        ("{position: {x: 1, y: 0, z: 2}}", "[1, 0, 2]"),
        ("{xyz: 0.2 0 0.1}", "[0.2, 0, 0.1]"),
    ],
)
def test_following_the_advice_on_a_value_of_the_wrong_shape_gives_a_valid_file(given, advised):
    found = problems(f"{HEAD}  - move_to: {{pose: {given}}}\n")
    assert any(f"`{advised}`" in problem.hint for problem in found)
    pose = advised if advised.startswith("{") else f"{{xyz: {advised}}}"
    parse_scenario(f"{HEAD}  - move_to: {{pose: {pose}}}\n", Path("f.yaml"))
