"""Percentages, expressions with pi, angles that look like degrees, and colours by name."""

import colorsys
import math
from pathlib import Path

import pytest
from pydantic import TypeAdapter, ValidationError

from harness.core.errors import SpecError
from harness.core.quantity import constant_of, split_quantity
from harness.language.base import Count
from harness.language.colors import color_of_name
from harness.language.reading.load import parse_scenario
from harness.plugins.cameras.expectations.sees import HUES, HueRange

HEAD = "scenario: x\nrobot: open_manipulator_x\nsteps:\n  - settle\n"


def load(lines):
    return parse_scenario(HEAD + lines + "\n", Path("f.yaml"))


def problem(lines):
    with pytest.raises(SpecError) as caught:
        load(lines)
    (found,) = caught.value.problems
    return found


def with_pose(pose, more=""):
    return f"objects:\n- {{name: a, box: {{size: [1, 1, 1]}}, pose: {pose}{more}}}"


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("pi", math.pi),
        ("π", math.pi),
        ("-pi/2", -math.pi / 2),
        ("pi / 4", math.pi / 4),
        ("2pi", math.tau),
        ("2 pi/3", 2 * math.pi / 3),
        ("0.5*pi", math.pi / 2),
        ("3*(pi - 1)/4", 3 * (math.pi - 1) / 4),
        ("tau/8", math.pi / 4),
        ("1/3", 1 / 3),
        ("-(1 + 0.5)", -1.5),
    ],
)
def test_an_expression_of_constants_is_an_angle(text, value):
    assert load(with_pose(f'{{rpy: [0, 0, "{text}"]}}')).scenario.objects[0].pose.rpy[2] == value
    assert split_quantity(text) == (value, "")


@pytest.mark.parametrize(
    "text",
    [
        *("90", "1e3", "pie", "pi**2", "pi//2", "pi/0", "2**9**9**9", "__import__('os')", "pi()"),
        *("", "(", "1 if 1 else 2", "pi, pi", "5 deg", "1e999*2", "1_000*2", "1j*2", "(" * 50),
    ],
)
def test_other_text_is_no_expression(text):
    assert constant_of(text) is None


def test_an_expression_is_no_length():
    assert "a length is a number, not `pi/2`" in problem(with_pose("{xyz: [0, 0, pi/2]}")).message


def test_expressions_stand_in_joints_goals_params_and_distributions():
    scenario = load(
        "params: {turn: pi/3}\nobjects:\n"
        "- {name: a, box: {size: [1, 1, 1]}, pose: {rpy: [0, 0, '${turn}']}}\n"
        "randomize: {objects.a.pose.rpy.2: {uniform: [-pi/4, pi/4]}}"
    ).scenario
    assert scenario.objects[0].pose.rpy[2] == math.pi / 3
    moved = "- move_to: {joints: {joint1: -pi/2}}"
    text = HEAD.replace("- settle", moved)
    assert parse_scenario(text, Path("f.yaml")).scenario.steps[0].joints["joint1"] == -math.pi / 2


@pytest.mark.parametrize(
    "lines", ["expect_rate: 90 %", "expect_rate: 0.9", "expect_rate: {at_least: 90%}"]
)
def test_a_rate_is_a_share_or_a_percentage(lines):
    expected = load(f"samples: 3\n{lines}").scenario.expect_rate
    assert (expected.at_least, expected.confidence) == (0.9, 0.95)


def test_percentages_stand_wherever_a_share_does():
    planning = load("planning: {max_velocity_scaling_factor: 30 %}").scenario.planning
    assert planning.max_velocity_scaling_factor == 0.3
    expect = load("expect: [{effort: 80 %}, {fraction: 99.5 %}]").scenario.expect
    assert (expect[0].max_fraction, expect[1].at_least) == (0.8, 0.995)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("samples: 3\nexpect_rate: 120 %", "must be at most 1"),
        ("samples: 3\nexpect_rate: 90 percent", "no unit is called `percent`"),
        ("samples: 3\nexpect_rate: most", "is a number or a percentage, not `most`"),
        (with_pose("{xyz: [0, 0, 5 %]}"), "`5 %` is a share; a length is expected"),
    ],
)
def test_what_is_no_share_is_refused(lines, message):
    assert message in problem(lines).message


@pytest.mark.parametrize("number", ["90", "-180", "45.5", "6.3"])
def test_an_angle_beyond_a_turn_is_noted_as_radians(number):
    (note,) = load(with_pose(f"{{rpy: [0, 0, {number}]}}")).notes
    assert (note.line, note.source_line[note.column - 1 :].split("]")[0]) == (6, number)
    assert f"{math.degrees(float(number)):.1f} degrees" in note.message
    assert note.hint == f"write `{number} deg` for degrees"


@pytest.mark.parametrize("number", ["90 deg", "6.2831853", "-3", "2pi", "0"])
def test_an_angle_of_at_most_a_turn_or_with_a_unit_is_not(number):
    assert load(with_pose(f"{{rpy: [0, 0, {number}]}}")).notes == ()


def test_lengths_and_joints_are_distinguished():
    assert load(with_pose("{xyz: [90, 0, 0]}")).notes == ()
    text = HEAD.replace("- settle", "- move_to: {joints: {joint1: 90, joint2: 1}}")
    (note,) = parse_scenario(text, Path("f.yaml")).notes
    assert note.column == text.splitlines()[3].index("90") + 1


def test_named_colors_are_those_of_css():
    from matplotlib.colors import CSS4_COLORS, to_rgba

    for name in (*CSS4_COLORS, "RebeccaPurple", "Steel Blue"):
        assert color_of_name(name) == pytest.approx(to_rgba(name.lower().replace(" ", "")))
    assert color_of_name("#00ff0080") == pytest.approx(to_rgba("#00ff0080"))


@pytest.mark.parametrize(
    ("color", "hint"),
    [
        ("rde", "`red`?"),
        ("steelblu", "`steelblue`?"),
        ("'#12345'", "#rrggbb"),
        ("blank", "CSS name"),
    ],
)
def test_an_unknown_color_is_refused(color, hint):
    found = problem(with_pose("{}", f", color: {color}"))
    assert "no colour is called" in found.message
    assert hint in found.hint


def test_a_color_is_a_name_or_numbers():
    assert load(with_pose("{}", ", color: lime")).scenario.objects[0].color == (0, 1, 0, 1)
    numbers = load(with_pose("{}", ", color: [0.1, 0.2, 0.3, 1]")).scenario.objects[0]
    assert numbers.color == (0.1, 0.2, 0.3, 1)
    assert "has 3 items" in problem(with_pose("{}", ", color: [0.1, 0.2, 0.3]")).message


@pytest.mark.parametrize("name", sorted(HUES.keys() - {"pink"}))
def test_sees_finds_an_object_by_the_name_of_its_color(name):
    """`pink` is the exception, and says so: objects have CSS's, a pale red."""
    hue, saturation, value = colorsys.rgb_to_hsv(*color_of_name(name)[:3])
    low, high = HUES[name]
    assert low <= 360 * hue <= high or (low > high and not high < 360 * hue < low)
    assert saturation > HueRange(named=name).min_saturation
    assert value > HueRange(named=name).min_value


@pytest.mark.parametrize("value", [-1, -10_000, 0.5, True])
def test_a_count_is_a_whole_number_from_0(value):
    counts = TypeAdapter(Count)
    assert [counts.validate_python(each) for each in (0, 1, 10_000)] == [0, 1, 10_000]
    with pytest.raises(ValidationError):
        counts.validate_python(value)
