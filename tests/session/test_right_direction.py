"""Verdicts change in the right direction: with friction, mass and grip, and not with the place."""

import pytest

from tests.adversarial.scenes import AT_BOX
from tests.session.front_door import failures, run

ARM = "{model: open_manipulator_x, base: {xyz: [0, 0, 0.01]}}"
BOX = "{name: red_box, box: {size: [0.04, 0.04, 0.08]}, pose: {xyz: [0.25, 0, 0.041]}, %s}"
LIFTED = "lifted: {object: red_box, above: 3 cm, for: 200 ms}"
STEPS = AT_BOX + "  - move_relative: {direction: {xyz: [0, 0, 1]}, distance: 4 cm}\n"
STEPS += "  - wait: 0.3 s\n"
CUBE = "{name: cube, box: {size: [0.04, 0.04, 0.04]}, mass: %s, friction: %s, pose: {xyz: [%s]}}"


def is_lifted(folder, *, friction=1.0, mass=0.05, effort=10.0):
    """Whether the arm lifts a box that it grips with a force, for 200 ms."""
    steps = STEPS.replace("max_effort: 10", f"max_effort: {effort:g}").replace("\n  ", "\n")
    rest = f"objects: [{BOX % f'mass: {mass:g}, friction: {friction:g}'}]\nexpect: [{{{LIFTED}}}]\n"
    result, _ = run(folder, steps, robot=ARM, rest=rest)
    [verdict] = result.verdicts
    assert verdict.status in ("passed", "failed"), failures(result)
    return verdict.status == "passed"


def slid(folder, *, friction=0.3, mass=0.05, force=5.0):
    """How far a push of 10 ms moves a cube on the floor [m]."""
    rest = f"objects: [{CUBE % (f'{mass:g}', f'{friction:g}', '0.4, 0.2, 0.0199')}]\n"
    rest += "expect: [{displaced: {object: cube, at_least: 1 mm}}]\n"
    steps = f"- inject: {{push: {{cube: [{force:g}, 0, 0]}}, push_duration: 10 ms}}\n- wait: 1 s\n"
    result, _ = run(folder, steps, robot=ARM, rest=rest)
    [verdict] = result.verdicts
    return verdict.margin + 0.001


@pytest.mark.nightly
def test_a_slippery_box_is_not_lifted_and_a_rough_one_is(tmp_path):
    assert not is_lifted(tmp_path, friction=0.02)
    assert is_lifted(tmp_path, friction=1.0)


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("what", "values"),
    [
        ("friction", [0.01, 0.03, 0.1, 0.3, 1.0, 2.0]),
        ("mass", [2.0, 1.0, 0.5, 0.2, 0.05, 0.01]),
        ("effort", [0.2, 0.5, 1.0, 3.0, 10.0]),
    ],
)
def test_more_friction_less_mass_and_a_firmer_grip_lift_what_less_of_it_lifted(
    what, values, tmp_path
):
    lifted = [is_lifted(tmp_path, **{what: value}) for value in values]
    assert lifted == sorted(lifted), dict(zip(values, lifted, strict=True))
    assert lifted[-1]
    assert not lifted[0]


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("what", "values"),
    [
        ("friction", [0.5, 0.4, 0.3, 0.2, 0.1]),
        ("mass", [0.2, 0.1, 0.07, 0.05, 0.03]),
        ("force", [2.0, 3.0, 4.0, 5.0, 6.0]),
    ],
)
def test_a_cube_slides_further_with_less_friction_less_mass_and_more_force(what, values, tmp_path):
    distances = [slid(tmp_path, **{what: value}) for value in values]
    assert distances == sorted(distances), dict(zip(values, distances, strict=True))
    assert distances[-1] > 2 * distances[0]
