"""A pick that does not hold the object fails `lifted` and `grasped`, whatever is believed."""

import textwrap

import pytest

from harness.cli.main import main
from tests.running import run_case
from tests.session.front_door import run

PICK = """
scenario: A pick that looks like one
robot: {{model: ur3e, gripper: rh_p12_rn_a, base: {{xyz: [0, 0, 1.02]}}}}
world: lesson_ur
{objects}
params: {{x: {x}}}
steps:
  - move_to: {{pose: {{frame: base_link, xyz: ["${{x}}", -0.168, 0.25], rpy: [180 deg, 0, 0]}}}}
  - lin: {{pose: {{frame: base_link, xyz: ["${{x}}", -0.168, 0.08], rpy: [180 deg, 0, 0]}}}}
  - {close}
  - attach_object: {{object: green_cylinder}}
    id: believe
  - move_relative: {{direction: {{xyz: [0, 0, 1]}}, distance: 0.15}}
    id: lift
  - wait: 3 s
expect:
  - lifted: {{object: green_cylinder, above: 5 cm, for: 2 s}}
  - grasped: green_cylinder
"""
CLOSE = "gripper: {position: 0.62}"
SLIPPERY = """
objects:
  - name: green_cylinder
    replace: true
    cylinder: {radius: 0.03, length: 0.1}
    pose: {xyz: [0.32, -0.168, 1.065]}
    mass: 0.1 kg
    friction: 0.01
"""


def run_pick(folder, *, x=0.32, close=CLOSE, objects=""):
    path = folder / "pick.scenario.yaml"
    path.write_text(textwrap.dedent(PICK).format(x=x, close=close, objects=objects))
    return run_case(path, stills=False)


@pytest.mark.nightly
def test_a_real_pick_passes_both(tmp_path):
    result = run_pick(tmp_path)
    assert [verdict.status for verdict in result.verdicts] == ["passed", "passed"], result


@pytest.mark.nightly(but=["friction 0.01-changes1"])
@pytest.mark.parametrize(
    ("what", "changes"),
    [
        ("closing 4 cm next to the box", {"x": 0.32 - 0.03 - 0.013 - 0.04}),
        ("friction 0.01", {"objects": SLIPPERY}),
        ("2 % of the grasp force", {"close": "gripper: {position: 0.62, max_effort: WEAK}"}),
        ("attached in the planning scene, never touched", {"close": "wait: 0.1 s"}),
    ],
)
def test_a_pick_that_does_not_hold_fails_both(tmp_path, what, changes):
    if "WEAK" in changes.get("close", ""):
        from harness.language.scenario import RobotSpec
        from harness.robot.load import load_robot

        gripper = load_robot(RobotSpec(gripper="rh_p12_rn_a")).gripper
        changes = {"close": changes["close"].replace("WEAK", f"{0.02 * gripper.grip_effort}")}
    result = run_pick(tmp_path, **changes)
    assert result.outcome == "failed", what
    lifted, grasped = result.verdicts
    for verdict in (lifted, grasped):
        assert verdict.status == "failed", (what, verdict)
        assert any(character.isdigit() for character in verdict.reason), verdict
    assert not any(step.status == "failed" for step in result.steps), result.steps


def test_what_carries_what_is_recorded_with_its_weight_and_direction(tmp_path):
    _, saved = run(
        tmp_path,
        "- wait: 0.3 s",
        rest="""
        objects:
          - {name: stool, box: {size: [0.1, 0.1, 0.1]}, mass: 200 g, pose: {xyz: [0.5, 0.4, 0.05]}}
          - {name: apple, box: {size: [0.04, 0.04, 0.04]}, mass: 100 g,
             pose: {xyz: [0.5, 0.4, 0.12]}}
        """,
    )
    carried = {pair: force[-1] for pair, force in saved.signals.support_forces.items()}
    assert carried["apple", "stool"] == pytest.approx(-0.1 * 9.8, rel=0.01)
    assert carried["ground_plane", "stool"] == pytest.approx(0.3 * 9.8, rel=0.01)


def test_half_a_run_does_not_pass_when_it_is_judged_again(tmp_path, capsys):
    result, _ = run(
        tmp_path,
        "- move_to: {position: {frame: base_link, xyz: [3, 0, 0]}}\n- wait: 0.1 s",
        rest="expect: [never: collision]",
    )
    assert (result.outcome, result.verdicts[0].status) == ("failed", "passed")
    assert main(["judge", str(tmp_path / "report")]) == 1
    assert "the run ended early with NO_IK_SOLUTION" in capsys.readouterr().out
