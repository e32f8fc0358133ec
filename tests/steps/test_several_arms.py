"""Steps of a robot with several arms: which arm, which gripper, and what both hold."""

from pathlib import Path

import pytest

from harness.judging.expectations.grasped import Grasped
from harness.judging.expectations.lifted import Lifted
from harness.judging.expectations.released import Released
from harness.plugins.assembly.steps.parallel import Delays
from harness.recording.read_run import read_run
from harness.session.check import check_file

PAIR = """\
robots:
  left: {model: ur3e, gripper: rh_p12_rn_a, base: {xyz: [0, 0.3, 0]}}
  right: {model: ur3e, gripper: rh_p12_rn_a, base: {xyz: [0, -0.3, 0]}}
"""


def box(name, x, y):
    shape = "box: {size: [0.05, 0.05, 0.08]}, mass: 0.1"
    return f"  - {{name: {name}, {shape}, pose: {{xyz: [{x}, {y}, 0.04]}}}}\n"


PICKS = f"""
scenario: each arm picks
{PAIR}
objects:
{box("a", 0.3, 0.3)}{box("b", 0.3, -0.3)}
steps:
  - pick: a
    robot: left
    expect: [grasped: a, lifted: a]
  - pick: b
    group: right
    expect: [grasped: b]
  - move_to: {{named_target: up}}
    group: arms
expect:
  - grasped: {{object: a, by: left}}
  - grasped: {{object: b, by: right}}
  - gripper: {{stalled: true, by: right}}
  - never: collision
"""


def test_either_hand_picks_and_both_arms_move_together(recorded_run):
    stored = read_run(recorded_run(PICKS) / "run")
    steps = {step.path: step for step in stored.run.steps}
    assert (steps["steps[0]"].arm, steps["steps[1].grasp"].arm) == ("left", "right")
    assert steps["steps[2]"].arm == ""
    assert len(steps["steps[2]"].trajectory.joint_names) == 12
    assert all(verdict.status == "passed" for verdict in stored.verdicts)


def test_only_the_hand_that_holds_an_object_has_grasped_it(recorded_run):
    recorded = read_run(recorded_run(PICKS) / "run").run
    for name, arm, other in (("a", "left", "right"), ("b", "right", "left")):
        assert Grasped(object=name, by=arm).verdict(recorded, "").status == "passed"
        assert Grasped(object=name, by=other).verdict(recorded, "").status == "failed"
        assert Lifted(object=name, by=other).verdict(recorded, "").status == "failed"
        assert Released(object=name, by=other).verdict(recorded, "").status == "passed"
        assert Released(object=name, by=arm).verdict(recorded, "").status == "failed"
        assert Released(object=name).verdict(recorded, "").status == "failed"


HAND_OVER = Path("scenarios/cells/hand_over.scenario.yaml")


@pytest.mark.nightly
def test_an_object_goes_from_hand_to_hand(recorded_run):
    stored = read_run(recorded_run(HAND_OVER) / "run")
    assert [verdict.status for verdict in stored.verdicts] == ["passed"] * len(stored.verdicts)
    links = [record.link for record in stored.run.attachments]
    assert links == ["left_end_effector_link", "right_end_effector_link"]


@pytest.mark.nightly
def test_while_both_hands_hold_neither_has_released(recorded_run):
    """A check that looks for one hand that holds would call this a finished hand-over."""
    recorded = read_run(recorded_run(HAND_OVER) / "run").run
    for arm in ("left", "right"):
        assert Grasped(object="rod", by=arm).verdict(recorded, "both_hold").status == "passed"
        assert Released(object="rod", by=arm).verdict(recorded, "both_hold").status == "failed"
    refused = next(step for step in recorded.steps if step.id == "too_early")
    assert "'rod' is held by left and right" in refused.message


def found(folder, steps, robot=PAIR, rest=""):
    path = folder / "a.scenario.yaml"
    path.write_text(f"scenario: a test\n{robot}steps:\n{steps}{rest}", encoding="utf-8")
    return [(each.line, each.message, each.hint) for each in check_file(path).problems]


@pytest.mark.parametrize(
    "step",
    [
        "move_to: up",
        "gripper: open",
        "move_relative: {direction: {xyz: [0, 0, 1]}, distance: 1 cm}",
    ],
)
def test_a_step_that_names_no_arm_is_reported_with_the_names(step, tmp_path):
    [(line, message, hint)] = found(tmp_path, f"  - {step}\n")
    assert (line, message) == (
        6,
        "the robot has several arms: left, right; this does not say which",
    )
    assert hint == "add `robot: left` or another one's name"


def test_an_arm_that_does_not_exist(tmp_path):
    [(_, message, hint)] = found(tmp_path, "  - move_to: up\n    robot: middle\n")
    assert (message, hint) == ("there is no arm 'middle'", "known: left, right")
    expected = "expect:\n  - grasped: {object: ground_plane, by: both}\n"
    problems = found(tmp_path, "  - move_to: up\n    robot: left\n", rest=expected)
    assert "there is no arm 'both'" in [message for _, message, _ in problems]


def test_a_group_of_another_arm(tmp_path):
    step = "  - move_to: up\n    robot: left\n    group: right\n"
    assert [each[1] for each in found(tmp_path, step)] == [
        "'right' is not a group of the arm 'left'"
    ]


def test_one_arm_needs_no_name(tmp_path):
    step = "  - move_to: up\n    robot: left\n"
    [(_, message, hint)] = found(tmp_path, step, robot="robot: ur3e\n")
    assert message == "the robot has one arm, and 'left' selects one of several"
    assert "leave out `robot`" in hint


@pytest.mark.parametrize("key", ["by: left", "by: right"])
def test_an_expectation_names_its_arm(key, tmp_path):
    steps = "  - gripper: open\n    robot: left\n"
    rest = "expect:\n  - gripper: {named_target: open}\n"
    [(line, _, hint)] = found(tmp_path, steps, rest=rest)
    assert (line, hint) == (9, "add `by: left` or another one's name")
    assert not found(tmp_path, steps, rest=rest.replace("open}", f"open, {key}}}"))


def test_a_mistake_under_an_arm_is_there(tmp_path):
    robot = PAIR.replace("{model: ur3e, gripper: rh_p12_rn_a, base: {xyz: [0, -0.3, 0]}}", "urx")
    [(line, message, _)] = found(tmp_path, "  - wait: 1\n", robot=robot)
    assert line == 4
    assert message.startswith("robots.right.model: 'urx' is not known")


ALLOWED = f"""
scenario: an arm may touch a pillar
{PAIR}
objects:
  - {{name: pillar, in: planning, box: {{size: [0.1, 0.1, 0.7]}}, pose: {{xyz: [0.4, 0, 0.35]}}}}
steps:
  - allow_collisions:
      pairs: [[ARM, pillar]]
      during:
        - ptp: {{joints: {{right_shoulder_pan_joint: 0, right_shoulder_lift_joint: -0.5,
            right_elbow_joint: 0.8, right_wrist_1_joint: -0.3}}}}
          robot: right
"""


@pytest.mark.nightly(but=[1])
@pytest.mark.parametrize(("arm", "outcome"), [("right", "passed"), ("left", "failed")])
def test_the_name_of_an_arm_allows_its_links_and_its_hand(arm, outcome, recorded_run):
    run = read_run(recorded_run(ALLOWED.replace("ARM", arm), outcome) / "run").run
    assert run.steps[-1].error_code == ("" if arm == "right" else "GOAL_IN_COLLISION")


def test_one_arm_or_several(tmp_path):
    [(_, message, _)] = found(tmp_path, "  - wait: 1\n", robot=f"robot: ur3e\n{PAIR}")
    assert message == "`robot` is one arm, and `robots` are several: give one of the two"


@pytest.mark.parametrize("y", [0.3, 0.24])
def test_arms_whose_bases_stand_inside_each_other(y, tmp_path):
    robot = PAIR.replace("[0, -0.3, 0]", f"[0, {y}, 0]")
    [(line, message, _)] = found(tmp_path, "  - wait: 1\n", robot=robot)
    assert line == 4
    pair = "'left' and 'right' stand inside each other: left_base_link_inertia"
    assert message.startswith(f"robots.right.base: {pair}")
    assert message.endswith("give one of them another `base`")


SWAP = f"""
scenario: one arm leaves, the other one comes
{PAIR}
steps:
  - move_to: {{pose: {{xyz: [0.3, 0.0, 0.25], rpy: [180 deg, 0, 0]}}}}
    robot: left
  - move_to: {{pose: {{xyz: [0.3, -0.25, 0.25], rpy: [180 deg, 0, 0]}}}}
    robot: right
  - parallel:
      - lin: {{pose: {{xyz: [0.3, 0.4, 0.25], rpy: [180 deg, 0, 0]}}}}
        robot: left
        planning: {{max_velocity_scaling_factor: 0.05}}
      - lin: {{pose: {{xyz: [0.3, 0.0, 0.25], rpy: [180 deg, 0, 0]}}}}
        robot: right
  - parallel:
      - gripper: closed
        robot: left
      - move_to: up
        robot: right
expect:
  - never: collision
  - always: within_limits
  - tcp_pose: {{pose: {{xyz: [0.3, 0.4, 0.25], rpy: [180 deg, 0, 0]}}, by: left}}
  - gripper: {{named_target: closed, by: left}}
"""


@pytest.mark.nightly
def test_an_arm_waits_until_the_other_one_has_left(recorded_run):
    stored = read_run(recorded_run(SWAP) / "run")
    assert all(verdict.status == "passed" for verdict in stored.verdicts)
    steps = {step.path: step for step in stored.run.steps}
    whole = steps["steps[2]"]
    first, second = (steps[f"steps[2].parallel[{number}]"] for number in range(2))
    begins = whole.result.find(Delays).delays
    assert begins[0] == 0 < begins[1] <= first.trajectory.duration
    pairs = zip(begins, (first, second), strict=True)
    ends = [begin + step.trajectory.duration for begin, step in pairs]
    assert whole.trajectory.duration == pytest.approx(max(ends))
    assert (first.end_time, second.end_time) == (whole.end_time, whole.end_time)


def at_once(*steps):
    return "  - parallel:\n" + "".join(f"      - {step}\n        {arm}\n" for step, arm in steps)


@pytest.mark.parametrize(
    ("second", "message"),
    [
        (("lin: {pose: {xyz: [0.3, 0, 0.3]}}", "robot: left"), "two motions of 'left'"),
        (("move_to: up", "group: arms"), "a motion that is of no single arm"),
    ],
)
def test_motions_at_once_are_of_different_arms(second, message, tmp_path):
    problems = found(tmp_path, at_once(("move_to: up", "robot: left"), second))
    assert f"{message} cannot run at once with others" in [each[1] for each in problems]


def test_two_arms_at_one_place_are_refused_with_the_pair(tmp_path):
    goal = "move_to: {pose: {xyz: [0.3, 0, 0.25], rpy: [180 deg, 0, 0]}}"
    text = at_once((goal, "robot: left"), (goal, "robot: right"))
    path = tmp_path / "a.scenario.yaml"
    path.write_text(f"scenario: a test\n{PAIR}steps:\n{text}", encoding="utf-8")
    failure = check_file(path).predicted[-1]
    assert failure.message.startswith("GOAL_IN_COLLISION")
    assert "left_" in failure.message
    assert "right_" in failure.message


NEIGHBOURS = """
scenario: a place for one of two arms
robots:
  left: {model: open_manipulator_x, base: {xyz: [0, 0.1, 0]}}
  right: {model: open_manipulator_x, base: {xyz: [0, -0.1, 0]}}
steps:
  - wait: 0.5
  - parallel:
      - move_to: {position: {xyz: [0.2, 0, 0.15]}}
        robot: %s
      - move_to: {position: {xyz: [0.2, 0, 0.15]}}
        robot: %s
"""


@pytest.mark.nightly
@pytest.mark.parametrize("arms", [("left", "right"), ("right", "left")])
def test_an_arm_in_the_way_at_the_end_is_refused_with_the_moment(arms, recorded_run):
    stored = read_run(recorded_run(NEIGHBOURS % arms, "failed") / "run")
    first, second = stored.run.steps[2:]
    assert (first.status, second.error_code) == ("passed", "GOAL_IN_COLLISION")
    assert all(f"{arm}_" in second.message for arm in arms)
    duration = first.trajectory.duration
    moment = f"at t={0.5 + duration:.3f} s, {duration:.3f} s into the motions, all others rest"
    assert second.message.endswith(moment)
    assert stored.run.ended_early.endswith(moment)


BOTH_PICK = f"""
scenario: both arms work at once
{PAIR}
objects:
{box("a", 0.3, 0.3)}{box("b", 0.3, -0.3)}
steps:
  - parallel:
      - pick: a
        robot: left
      - pick: b
        robot: right
"""
BOTH_PLACE = """
  - parallel:
      - place: {{object: a, pose: {{xyz: [0.3, {0}, 0.041]}}}}
        robot: left
      - place: {{object: b, pose: {{xyz: [0.3, -{0}, 0.041]}}}}
        robot: right
"""


@pytest.mark.nightly
def test_two_arms_pick_at_once(recorded_run):
    text = BOTH_PICK + (
        "expect:\n  - grasped: {object: a, by: left}\n  - lifted: {object: b, by: right}\n"
        "  - never: collision\n"
    )
    stored = read_run(recorded_run(text) / "run")
    assert [verdict.status for verdict in stored.verdicts] == ["passed"] * 3
    steps = {step.path: step for step in stored.run.steps}
    left, right = ({p: steps[f"steps[0].parallel[{n}].{p}"] for p in PARTS} for n in range(2))
    for part in ("reach", "approach", "lift"):
        assert left[part].end_time == right[part].end_time
    assert [step.arm for step in right.values()] == ["right"] * len(PARTS)
    assert steps["steps[0].parallel[1]"].start_time == 0
    assert steps["steps[0].parallel[0]"].end_time == steps["steps[0]"].end_time


PARTS = ("open", "reach", "approach", "grasp", "lift")


@pytest.mark.nightly
def test_places_next_to_each_other_wait_for_the_hand_that_opens(recorded_run):
    """Each place is free by itself; the hands do not fit next to each other."""
    text = BOTH_PICK + BOTH_PLACE.format(0.11) + "expect:\n  - placed: a\n  - never: collision\n"
    stored = read_run(recorded_run(text) / "run")
    assert [verdict.status for verdict in stored.verdicts] == ["passed"] * 2


@pytest.mark.nightly
def test_a_place_under_the_hand_that_stays_there_is_refused_before_anything_touches(recorded_run):
    text = BOTH_PICK + BOTH_PLACE.format(0.05) + "expect:\n  - placed: b\n  - never: collision\n"
    stored = read_run(recorded_run(text, "failed") / "run")
    second = next(step for step in stored.run.steps if step.path == "steps[1].parallel[1]")
    assert second.error_code == "GOAL_IN_COLLISION"
    assert "left_rh_p12_rn" in second.message
    assert [verdict.status for verdict in stored.verdicts] == ["not reached", "passed"]


def test_a_pick_in_motion_is_no_step_of_two_arms_at_once(tmp_path):
    text = at_once(
        ("pick: {object: a, track: true}", "robot: left"), ("move_to: up", "robot: right")
    )
    problems = found(tmp_path, text, rest="objects:\n" + box("a", 0.3, 0.3))
    assert any("`pick` or `place` without `track`" in message for _, message, _ in problems)


@pytest.mark.parametrize("y", [-0.3, 0.9, 9.0])
def test_arms_that_stand_apart(y, tmp_path):
    robot = PAIR.replace("[0, -0.3, 0]", f"[0, {y}, 0]")
    assert not found(tmp_path, "  - wait: 1\n", robot=robot)


def test_a_guarded_move_at_once_with_another_motion_is_refused(tmp_path):
    pair = "".join(
        f"  {arm}: {{model: open_manipulator_x, base: {{xyz: [0, {y}, 0]}}}}\n"
        for arm, y in (("left", 0.3), ("right", -0.3))
    )
    guarded = "{direction: {xyz: [0, 0, -1]}, force: 5 N, max_distance: 1 cm, speed: 1 cm/s}"
    turn = "ptp: {joints: {right_joint1: -0.4}}"
    text = at_once((f"move_until: {guarded}", "robot: left"), (turn, "robot: right"))
    path = tmp_path / "a.scenario.yaml"
    path.write_text(f"scenario: a test\nrobots:\n{pair}steps:\n{text}", encoding="utf-8")
    failure = check_file(path).predicted[-1]
    assert (
        "`move_until` ends by what it meets, so it cannot be timed with another" in failure.message
    )
