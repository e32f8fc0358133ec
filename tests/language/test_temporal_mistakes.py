"""Predicates that are negated, or bound to a time, in words that the language does not have."""

import re
from pathlib import Path

import pytest

from harness.core.errors import SpecError
from harness.language.reading.load import parse_scenario

HEAD = "scenario: x\nrobot: ur3e\nsteps: [settle]\nexpect:\n"


@pytest.mark.parametrize(
    ("written", "advice"),
    [
        ("§no_collision", "never: collision"),
        ("§no-collision", "never: collision"),
        ("§never collision", "never: collision"),
        ("§collision_free", "never: collision"),
        ("§no_collisions: [robot, table]", "never: {collision: [robot, table]}"),
        ("collision: §never", "never: collision"),
        ("collision: §none", "never: collision"),
        ("collision: §false", "never: collision"),
        ("§not_grasped: cube", "never: {grasped: cube}"),
        ("§not_grasped: cube", "released: cube"),
        ("§not_held: cube", "never: {grasped: cube}"),
        ("§not_lifted: cube", "never: {lifted: cube}"),
        ("§not_inside: {object: a, container: b}", "never: {in: {...}}"),
        ("§no_contact: [a, b]", "never: {in_contact: [a, b]}"),
        ("§no_contact", "never: {in_contact: [ONE, OTHER]}"),
        ("in_contact: §never", "never: {in_contact: [ONE, OTHER]}"),
        ("§always_upright: cube", "always: {upright: cube}"),
        ("§stays_upright: cube", "always: {upright: cube}"),
        ("§upright_always: cube", "always: {upright: cube}"),
        ("upright: §always", "always: {upright: OBJECT}"),
        ("static: §always", "always: static"),
        ("§eventually_placed: cube", "eventually: {placed: cube}"),
        ("§no_slip: cube", "slip"),
        ("§without_tracking_error", "tracking_error"),
        ("always: {upright: §never}", "never: {upright: OBJECT}"),
    ],
)
def test_advice_keeps_the_meaning_and_can_be_followed(written, advice):
    line = f"- {written}"
    with pytest.raises(SpecError) as caught:
        parse_scenario(HEAD + line.replace("§", "") + "\n", Path("f.yaml"))
    problem = caught.value.problems[0]
    assert (problem.line, problem.column) == (5, line.index("§") + 1)
    advised = re.findall(r"`([^`]+)`", problem.hint)
    assert advice in advised
    assert "collision" not in advised
    if "..." not in advice and advice != "slip":
        parse_scenario(f"{HEAD}- {advice}\n", Path("f.yaml"))


def test_an_object_called_always_can_still_be_named():
    text = f"{HEAD}- upright: {{object: always}}\n"
    assert parse_scenario(text, Path("f.yaml")).scenario.expect[0].object == "always"


def test_words_that_only_look_temporal_are_misspelt_names():
    with pytest.raises(SpecError) as caught:
        parse_scenario(f"{HEAD}- nothing\n", Path("f.yaml"))
    assert caught.value.problems[0].hint.startswith("predicates: ")
