"""Random valid scenarios end with an outcome; motions are within limits, digests repeat."""

from dataclasses import replace

import pytest

from harness.recording.read_run import read_run
from tests.campaigns.generated import drawn_scenario, ends_well, is_read
from tests.campaigns.invariants import assert_invariants

HELD = """\
scenario: an attachment
robot: open_manipulator_x
objects: [{name: block, box: {size: [2 cm, 2 cm, 4 cm]}, mass: 20 g, pose: {xyz: [0.2, 0, 0.02]}}]
steps: [{move_to: {joints: {joint1: 0.5}}}, {attach_object: {object: block, link: link5}}]
"""


@pytest.mark.nightly(but=["2"])
@pytest.mark.parametrize("seed", range(60))
def test_a_drawn_scenario_ends_with_an_outcome_and_one_digest(seed, tmp_path):
    end, _ = ends_well(seed, tmp_path)
    assert end in ("passed", "failed", "refused")


@pytest.mark.nightly
def test_most_words_of_the_language_are_drawn():
    """And what is drawn is read; the test could not fail where nothing is."""
    drawn = [drawn_scenario(seed) for seed in range(15)]
    assert all(map(is_read, drawn))
    verbs = {verb for each in drawn for step in each["steps"] for verb in step}
    assert len(verbs) > 12, verbs
    assert any(each.get("expect") for each in drawn)


def test_an_invariant_that_does_not_hold_is_noticed(recorded_run):
    """A faster motion, a command outside, and an attachment that nothing ended."""
    run = read_run(recorded_run(HELD, stills=False) / "run").run
    assert_invariants(run)
    step = next(each for each in run.steps if each.trajectory is not None)
    faster = replace(step.trajectory, times=step.trajectory.times / 10)
    steps = tuple(replace(step, trajectory=faster) if each is step else each for each in run.steps)
    with pytest.raises(AssertionError):
        assert_invariants(replace(run, steps=steps))
    outside = replace(run.signals, joint_commands=run.signals.joint_commands + 7.0)
    with pytest.raises(AssertionError):
        assert_invariants(replace(run, signals=outside))
    [held] = run.attachments
    with pytest.raises(AssertionError):
        assert_invariants(replace(run, attachments=(replace(held, end_time=0.1),)))
