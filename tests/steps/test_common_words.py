"""Words that people write first: `on`, `gripper`, `opened`."""

import pytest

from tests.session.front_door import check, failures, problems, run

OM = "open_manipulator_x"
UR3E = "{model: ur3e, gripper: rh_p12_rn_a}"


@pytest.mark.nightly(but=["open_manipulator_x-words0"])
@pytest.mark.parametrize(
    ("robot", "words"), [(OM, ("closed", "opened")), (UR3E, ("close", "opened"))]
)
def test_a_state_of_a_gripper_has_two_forms(tmp_path, robot, words):
    steps = "".join(
        f"- gripper: {word}\n  expect: [{{gripper: {word}}}, {{named_target: {{state: {word},"
        " group: gripper}}]\n"
        for word in words
    )
    result, record = run(tmp_path, steps, robot=robot)
    assert result.outcome == "passed", failures(result)
    states = record.robot.states_of("gripper")
    assert not set(words) & set(states)


def test_a_state_that_has_no_other_form_is_unknown(tmp_path):
    [(_, message)] = problems(tmp_path, "- gripper: shut", robot=OM)
    assert message == "there is no named state of gripper called 'shut'"
    named = (
        "{model: open_manipulator_x, named_states: {gripper: {closed: {gripper_left_joint: 0}}}}"
    )
    assert not problems(tmp_path, "- gripper: closed", robot=named)


OBJECTS = """\
objects:
  - {name: part, box: {size: [3 cm, 3 cm, 3 cm]}, mass: 0.05, pose: {xyz: [0.35, 0.1, 0.015]}}
  - {name: table, shapes: [
      {box: {size: [4 cm, 4 cm, 6 cm]}, pose: {xyz: [0, 0, -4 cm]}},
      {box: {size: [24 cm, 20 cm, 2 cm]}}], static: true,
     pose: {xyz: [0.3, -0.2, 0.07], rpy: [0, 0, 30 deg]}}
  - {name: wedge, box: {size: [0.2, 0.2, 0.02]}, static: true,
     pose: {xyz: [-0.3, 0.2, 0.1], rpy: [20 deg, 0, 0]}}
"""
IN_THE_MIDDLE = """
  - {name: cup, cylinder: {radius: 3 cm, length: 8 cm}, pose: {frame: table, xyz: [0, 0, 0.05]},
     mass: 0.1}
"""


@pytest.mark.nightly
@pytest.mark.parametrize("more", ["", IN_THE_MIDDLE])
def test_an_object_is_placed_on_a_support_at_the_free_place_nearest_to_its_middle(tmp_path, more):
    steps = """
    - pick: part
    - place: {object: part, on: table}
    - settle
      expect: [{placed: {object: part, on: table}}, {upright: part}]
    """.replace("- settle\n", "- settle: {}\n")
    result, record = run(tmp_path, steps, robot=UR3E, rest=OBJECTS + more.lstrip("\n"))
    assert result.outcome == "passed", (failures(result), [s.message for s in result.steps])
    away = record.signals.object_poses["part"][-1][:2] - [0.3, -0.2]
    distance = float((away @ away) ** 0.5)
    assert distance < 0.005 if not more else 0.04 < distance < 0.1


@pytest.mark.parametrize(
    ("support", "message"),
    [
        ("ground_plane", "'ground_plane' has no middle that something could be put on"),
        ("part", "'part' cannot stand on itself"),
        ("tabel", "there is no object 'tabel'"),
    ],
)
def test_what_nothing_can_be_put_on_is_refused_with_the_way_out(tmp_path, support, message):
    steps = f"- pick: part\n- place: {{object: part, on: {support}}}"
    report = check(tmp_path, steps, robot=UR3E, rest=OBJECTS)
    [problem] = report.problems
    assert (problem.line, problem.message) == (6, message)
    assert "pose: {xyz: [X, Y, Z]}" in problem.hint or "did you mean `table`" in problem.hint


def test_a_tilted_support_has_no_top(tmp_path):
    steps = "- pick: part\n- place: {object: part, on: wedge}"
    [problem] = check(tmp_path, steps, robot=UR3E, rest=OBJECTS).predicted
    assert "'wedge' is tilted, so it has no top" in problem.message


@pytest.mark.parametrize(
    "keys", ["object: part", "{object: part, on: table, pose: {xyz: [0, 0, 0]}}"]
)
def test_a_place_is_a_pose_or_a_support(tmp_path, keys):
    steps = f"- pick: part\n- place: {keys if keys[0] == '{' else f'{{{keys}}}'}"
    [(line, message)] = problems(tmp_path, steps, robot=UR3E, rest=OBJECTS)
    assert line == 6
    assert "exactly one of `pose`, and `on`" in message


def test_the_gripper_is_a_body_that_may_touch(tmp_path):
    """The fingers reach into the wall; without a gripper the word means nothing."""
    rest = (
        "objects:\n  - {name: wall, box: {size: [2 cm, 30 cm, 10 cm]}, static: true,"
        " pose: {xyz: [0.26, 0, 0.1]}, in: planning}"
    )
    into = "{move_to: {position: [0.24, 0, 0.1]}}"
    allowed = f"- allow_collisions: {{pairs: [[wall, gripper]], during: [{into}]}}"
    [blocked] = check(tmp_path, f"- {into}", robot=OM, rest=rest).predicted
    assert blocked.message.startswith("GOAL_IN_COLLISION")
    report = check(tmp_path, allowed, robot=OM, rest=rest)
    assert not report.problems
    assert not report.predicted
    [(line, message)] = problems(tmp_path, allowed, robot="ur3e", rest=rest)
    assert line == 5
    assert "gripper" in message


@pytest.mark.nightly(but=["- pick: part-False"])
@pytest.mark.parametrize(
    ("steps", "is_noted"),
    [
        ("- attach_object: part\n- move_to: {joints: {joint1: 0.3}}", True),
        ("- attach_object: part\n- wait: 0.1\n- detach_object: part", True),
        ("- attach_object: part\n- detach_object: part", False),
        ("- pick: part", False),
    ],
)
def test_an_attachment_of_what_no_finger_holds_is_noted(tmp_path, steps, is_noted):
    rest = OBJECTS.split("  - {name: table")[0].replace("0.35, 0.1", "0.2, 0")
    result, _ = run(tmp_path, steps, robot=OM, rest=rest)
    noted = [note for note in result.notes if "carries nothing in the physics" in note]
    assert len(noted) == int(is_noted), (result.notes, [s.message for s in result.steps])
