"""What people write from habit, or for a plug-in that is not loaded, has an answer."""

from pathlib import Path

import pytest

from harness.core.errors import SpecError
from harness.language.reading.load import parse_scenario
from harness.language.variation import Distribution

HEAD = "scenario: x\nrobot: ur3e\nsteps:\n  - wait: 1 s\n"


def problems(text):
    with pytest.raises(SpecError) as caught:
        parse_scenario(text, Path("f.yaml"))
    return [(each.message, each.hint) for each in caught.value.problems]


@pytest.mark.parametrize(
    ("formula", "hint"),
    [
        ("always z(part) => 0", "write `>=`"),
        ("z(part) =< 1", "write `<=`"),
        ("z(part) ≥ 0", "write `>=`"),
        ("z(part) == 1", "write `>=` or `<=`: two numbers are hardly ever equal"),
        ("z(part) $ 1", 'names with other characters stand in quotes: z("my box")'),
    ],
)
def test_a_sign_of_another_language_is_answered_with_that_of_formulas(formula, hint):
    [(message, said)] = problems(f"{HEAD}expect:\n  - formula: '{formula}'\n")
    assert message.endswith("has no meaning in a formula")
    assert said == hint


@pytest.mark.parametrize(
    ("shape", "hint"),
    [
        ("type: box, dimensions: [1, 2, 3]", "write `box: {size: [1, 2, 3]}`"),
        ("type: sphere, dimensions: [0.1]", "write `sphere: {radius: 0.1}`"),
        ("type: CYLINDER, dimensions: [2, 0.1]", "write `cylinder: {length: 2, radius: 0.1}`"),
        ("type: box", "write `box: {size: [X, Y, Z]}`"),
        ("type: 1", "the shape is a key: `box: {size: [X, Y, Z]}`"),
    ],
)
def test_a_shape_of_moveit_is_answered_with_the_shape_as_a_key(shape, hint):
    text = f"{HEAD}objects:\n  - {{name: part, {shape}, pose: {{xyz: [1, 0, 1]}}}}\n"
    hints = dict(problems(text))
    assert hints["unknown key `type`"].startswith(hint)


@pytest.mark.parametrize(
    ("keys", "intended"),
    [
        ("position: [1, 0, 1]", "pose"),
        ("xyz: [1, 0, 1]", "pose"),
        ("pose: {position: [1, 0, 1]}", "xyz"),
        ("weight: 1", "mass"),
    ],
)
def test_a_key_of_other_tools_is_answered_with_the_key_of_the_same_place(keys, intended):
    found = problems(f"{HEAD}objects:\n  - {{name: part, box: {{size: [1, 1, 1]}}, {keys}}}\n")
    assert f"did you mean `{intended}`?" in found[0][1]


@pytest.mark.parametrize(
    "expectation", ["tcp_inside: {at_most: 90 cm}", "held_tightly: part", "tcp_pose_: {most: 1}"]
)
def test_an_unknown_word_is_one_problem_and_names_plug_ins(expectation):
    """No problem is about another word, which the file does not contain, unless it is a slip."""
    found = problems(f"{HEAD}expect:\n  - {expectation}\n")
    word = expectation.partition(":")[0]
    message, hint = found[0]
    assert message == f"no predicate is called `{word}`"
    is_slip = word == "tcp_pose_"
    assert ("a predicate of a plug-in that is not installed needs `--plugin`" in hint) != is_slip
    assert len(found) == 1 + is_slip


def test_a_misspelt_word_with_known_keys_still_reports_what_is_wrong_inside():
    [word, inside] = problems(f"{HEAD}expect:\n  - grasp: {{object: part, max_slip: 2 kg}}\n")
    assert "did you mean `grasped`?" in word[1]
    assert "kg" in inside[0]


@pytest.mark.parametrize(
    ("distribution", "middle"),
    [
        ({"normal": {"mean": 0, "std": "10 cm"}}, "0.0 cm"),
        ({"uniform": [0, "10 cm"]}, "5.0 cm"),
        ({"normal": {"mean": "5 cm", "std": "1 cm", "low": 0}}, "5.0 cm"),
        ({"uniform": ["-90 deg", 0]}, "-45.0 deg"),
    ],
)
def test_a_zero_in_a_distribution_needs_no_unit(distribution, middle):
    text = f"{HEAD}params: {{x: 1}}\nsamples: 2\nrandomize: {{x: {distribution}}}\n"
    parse_scenario(text, Path("f.yaml"))
    value = Distribution(**distribution).at(0.5)
    assert value.split()[1] == middle.split()[1]
    assert float(value.split()[0]) == pytest.approx(float(middle.split()[0]), abs=1e-4)


def test_other_numbers_of_a_distribution_need_their_unit():
    text = f"{HEAD}params: {{x: 1}}\nsamples: 2\nrandomize: {{x: {{uniform: [5, 10 cm]}}}}\n"
    assert problems(text)[0][0] == "`5`, `10 cm` must be in one unit"
