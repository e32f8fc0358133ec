"""A varied parameter that no `${name}` of the file reads is noted at its line."""

from pathlib import Path

import pytest

from harness.language.reading.load import parse_scenario

HEAD = """scenario: a
robot: ur3e
params: {x: 0.2, y: 0.1, n: 3, deep: {z: 1}}
"""
STEPS = 'steps: [{move_to: {position: {xyz: ["${x}", 0.2, 0.3]}, pitch: 0}}]\n'


def notes(text):
    return [str(note) for note in parse_scenario(HEAD + text, Path("a.yaml")).notes]


@pytest.mark.parametrize(
    ("varied", "name"),
    [
        ("randomize: {y: {uniform: [0, 1]}}\nsamples: 3\n", "y"),
        ("randomize: {params.y: {choice: [0, 1]}}\nsamples: 3\n", "y"),
        ("parametrize: {y: [0, 1]}\n", "y"),
        ("parametrize: [{id: one, y: 0, x: 0.1}, {id: two, y: 1, x: 0.3}]\n", "y"),
        ("randomize: {deep.z: {uniform: [0, 1]}}\nsamples: 3\n", "deep"),
    ],
)
def test_a_varied_parameter_that_nothing_reads_is_noted(varied, name):
    (note,) = notes(varied + STEPS)
    assert note.startswith("a.yaml:4:")
    assert f"nothing reads the parameter `{name}`, so that its values change nothing" in note
    assert f"write `${{{name}}}` where they belong" in note


@pytest.mark.parametrize(
    "text",
    [
        "randomize: {x: {uniform: [0.1, 0.2]}}\nsamples: 3\n" + STEPS,
        "randomize: {x: {uniform: [0.1, 0.2]}}\nsamples: '${n}'\n" + STEPS,
        "parametrize: {y: [0, 1]}\nsteps: [{wait: 1, id: 'at_${y}'}]\n",
        "parametrize: {steps.0.wait: [1, 2]}\nsteps: [{wait: 1}]\n",
        STEPS,
    ],
)
def test_what_is_read_or_does_not_vary_is_not_noted(text):
    assert notes(text) == []
