from pathlib import Path

import pytest

from harness.core.errors import SpecError
from harness.judging.expectations.always import Always
from harness.judging.expectations.eventually import Eventually
from harness.judging.expectations.grasped import Grasped
from harness.judging.expectations.lifted import Lifted
from harness.judging.expectations.never import Never
from harness.judging.expectations.within_limits import WithinLimits
from harness.language.reading.load import bundled_worlds, load_scenario, load_world, parse_scenario
from harness.plugins.formulas.expectations.until import Until
from harness.plugins.scene.steps.add_object import AddObject
from harness.plugins.scene.steps.allow_collisions import AllowCollisions
from harness.plugins.scene.steps.clear_objects import ClearObjects
from harness.steps.gripper import Gripper
from harness.steps.move_to import MoveTo
from harness.steps.wait import Wait

FILES = Path(__file__).parent / "files"
HEAD = "scenario: x\nrobot: ur3e\n"


def parse(text):
    return parse_scenario(text, Path("f.yaml"))


def steps(*lines):
    return parse(HEAD + "steps:\n" + "\n".join(lines) + "\n").scenario.steps


def expectations(*lines):
    text = HEAD + "steps: [settle]\nexpect:\n" + "\n".join(lines) + "\n"
    return parse(text).scenario.expect


def problems(text):
    with pytest.raises(SpecError) as caught:
        parse(text)
    return caught.value.problems


def test_the_designs_example_loads_as_it_is():
    scenario = load_scenario(FILES / "design.yaml").scenario
    assert scenario.robot.gripper == "rh_p12_rn_a"
    assert scenario.steps[0] == MoveTo(named_target="mogi_home")
    assert scenario.steps[1] == Gripper(named_target="open")
    assert scenario.steps[2].id == "above"
    assert scenario.steps[5].distance == 0.1
    assert scenario.steps[5].expect == (Grasped(object="green_cylinder"),)
    lifted = scenario.expect[0]
    assert isinstance(lifted, Lifted)
    assert (lifted.above, lifted.for_) == (0.05, 1.0)
    assert scenario.expect[2] == Always(predicate=WithinLimits())


def test_a_path_in_the_model_leads_to_its_line_and_column():
    lines = load_scenario(FILES / "design.yaml").lines
    for loc, place in {
        ("steps", 2): (13, 5),
        ("steps", 0, "named_target"): (11, 14),
        ("steps", 2, "pose", "xyz", 1): (14, 44),
        ("steps", 2, "pose", "rpy"): (14, 13),  # not in the file: where it would stand
        ("steps", 5, "expect", 0, "object"): (20, 27),
        ("expect", 1): (23, 5),
        ("expect", 1, "predicate"): (23, 13),
        ("expect", 1, "predicate", "between", 1): (23, 42),
        ("world",): (6, 8),
    }.items():
        assert lines.line_of(loc) == place, loc


def test_an_engines_problem_is_rendered_with_the_source_line():
    lines = load_scenario(FILES / "design.yaml").lines
    problem = lines.problem(("steps", 4, "object"), "no object is called `x`", "objects: a, b")
    assert problem.line == 17
    assert "green_cylinder" in problem.source_line
    assert str(problem).count("^" * len("green_cylinder")) == 1


def test_a_bare_verb_and_a_verb_without_content_are_steps():
    assert steps("- clear_objects", "- clear_objects:", "- clear_objects: {world: true}") == (
        ClearObjects(),
        ClearObjects(),
        ClearObjects(world=True),
    )


def test_reserved_words_stand_next_to_the_verb_in_any_order():
    (step,) = steps(
        "- id: a",
        "  expect_error: NO_IK_SOLUTION",
        "  wait: 2 s",
        "  timeout: 500 ms",
        "  expect: [within_limits]",
    )
    assert step == Wait(
        id="a",
        expect_error="NO_IK_SOLUTION",
        duration=2.0,
        timeout=0.5,
        expect=(WithinLimits(),),
    )


def test_nested_steps_have_short_forms_too():
    (step,) = steps(
        "- allow_collisions:",
        "    pairs: [[a, b]]",
        "    during:",
        "      - gripper: open",
        "      - repeat: {times: 2, steps: [settle, {wait: 1}]}",
        "      - parallel: [{move_to: up}, {gripper: closed}]",
    )
    assert isinstance(step, AllowCollisions)
    assert step.during[0] == Gripper(named_target="open")
    assert step.during[1].steps[1] == Wait(duration=1.0)
    assert step.during[2].steps[0] == MoveTo(named_target="up")


def test_one_object_or_several_may_be_added():
    one = "{name: a, box: {size: [1, 1, 1]}}"
    added = steps(
        f"- add_object: {one}", f"- add_object: [{one}]", f"- add_object: {{objects: [{one}]}}"
    )
    assert added[0] == added[1] == added[2]
    assert isinstance(added[0], AddObject)
    assert added[0].objects[0].name == "a"


def test_friction_is_a_number_or_three():
    spec = "- add_object: {name: a, sphere: {radius: 1 cm}, friction: %s}"
    assert steps(spec % "0.5")[0].objects[0].friction == 0.5
    assert steps(spec % "{sliding: 0.5}")[0].objects[0].friction.sliding == 0.5


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("- within_limits", WithinLimits()),
        ("- always: within_limits", Always(predicate=WithinLimits())),
        ("- grasped: a", Grasped(object="a")),
        ("- {grasped: a, for: 1 s}", Grasped(object="a", for_=1.0)),
        ("- grasped: {object: a, for: 1 s}", Grasped(object="a", for_=1.0)),
        (
            "- never: {grasped: a, during: up}",
            Never(predicate=Grasped(object="a"), during="up"),
        ),
        (
            "- eventually: {lifted: {object: a, above: 5 cm}, for: 1 s, during: up}",
            Eventually(predicate=Lifted(object="a", above=0.05), for_=1.0, during="up"),
        ),
        (
            "- eventually: {lifted: {object: a, for: 1 s}}",
            Eventually(predicate=Lifted(object="a", for_=1.0)),
        ),
        (
            "- {always: {grasped: a}, until: {lifted: b}, within: 2}",
            Until(predicate=Grasped(object="a"), until=Lifted(object="b"), within=2.0),
        ),
    ],
)
def test_expectations_read_like_sentences(line, expected):
    assert expectations(line) == (expected,)


def test_the_field_until_is_found_though_the_tag_has_its_name():
    line = "- {always: {grasped: a}, until: {lifted: {object: 5}}}"
    (problem,) = problems(HEAD + "steps: [settle]\nexpect:\n" + line)
    assert (problem.line, problem.column) == (5, line.index("5") + 1)
    loaded = parse(HEAD + "steps: [settle]\nexpect:\n" + line.replace("5", "b"))
    assert loaded.lines.line_of(("expect", 0, "until", "object")) == (5, line.index("5") + 1)
    assert loaded.lines.line_of(("expect", 0, "predicate", "object")) == (5, line.index("a}") + 1)


def test_a_key_of_another_program_is_met_with_the_key_here():
    (problem,) = problems("scenario: x\nrobot: {ur_type: ur3e}\nsteps: [settle]")
    assert "did you mean `model`?" in problem.hint


def test_on_is_a_key_and_a_predicate():
    (check,) = expectations("- on: {object: a, support: b}")
    assert check.support == "b"


@pytest.mark.parametrize("word", ["yes", "on", "1", '"true"'])
def test_only_true_and_false_are_booleans(word):
    (problem,) = problems(HEAD + f"steps: [{{clear_objects: {{world: {word}}}}}]")
    assert "is true or false" in problem.message


@pytest.mark.parametrize("word", ["true", '"0.5"', "1.5", "0"])
def test_a_scaling_factor_is_a_number_up_to_one(word):
    text = HEAD + f"planning: {{max_velocity_scaling_factor: {word}}}\nsteps: [settle]"
    (problem,) = problems(text)
    assert problem.line == 3
    assert "`max_velocity_scaling_factor` " in problem.message


@pytest.mark.parametrize("name", bundled_worlds())
def test_bundled_worlds_load(name):
    world = load_world(name, Path())
    assert world.model.world == name


def test_a_world_is_a_name_or_a_file_next_to_the_scenario(tmp_path):
    (tmp_path / "my.yaml").write_text("world: mine\nobjects: [{name: a, sphere: {radius: 1 cm}}]\n")
    assert load_world("my.yaml", tmp_path).model.objects[0].sphere.radius == 0.01
    for name, message, hint in (
        ("lesson_urr", "no world is called `lesson_urr`", "did you mean `lesson_ur`?"),
        ("none.yaml", "world `none.yaml`: there is no such file", ""),
        ("room.scene", "a MoveIt scene is no world yet", "`harness import scene room.scene`"),
        ("https://example.org/w.yaml", "is a URL", ""),
        ("a\0b.yaml", "is not a path", ""),
    ):
        with pytest.raises(SpecError) as caught:
            load_world(name, tmp_path)
        assert message in caught.value.problems[0].message
        assert hint in caught.value.problems[0].hint


def test_a_world_files_mistakes_are_located(tmp_path):
    (tmp_path / "my.yaml").write_text("world: mine\nobjects:\n  - {name: a, spher: {radius: 1}}\n")
    with pytest.raises(SpecError) as caught:
        load_world("my.yaml", tmp_path)
    problem = caught.value.problems[0]
    assert (problem.line, problem.column) == (3, 15)
    assert problem.path == str(tmp_path / "my.yaml")
