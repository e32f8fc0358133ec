"""pick and place choose what the file leaves open, and say what to do in keys that they have."""

import re

import pytest

from harness.recording.explanation import recorded_explanation
from tests.session.front_door import UR, check, failures, problems, run

OM = "open_manipulator_x"
UR3E = "{model: ur3e, gripper: rh_p12_rn_a}"
UR5E = "{model: ur5e, gripper: rh_p12_rn_a}"


def cube(name, size, x, y, more=""):
    """A cube of a size [cm] on the floor."""
    return (
        f"- {{name: {name}, box: {{size: [{size} cm, {size} cm, {size} cm]}},"
        f" pose: {{xyz: [{x}, {y}, {size / 200}]{more}}}, mass: 0.05}}"
    )


def objects(*lines):
    return "objects:\n" + "\n".join(f"  {line}" for line in lines)


def advice(record, path="steps[0]"):
    return (
        next(step for step in record.steps if step.path == path)
        .explanation.plain()
        .get("advice", "")
    )


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(
    ("lower", "upper"),
    [
        (cube("lower", 4, 0.25, 0.0), cube("upper", 4, 0.2, -0.1, ", rpy: [0, 0, 20 deg]")),
        (cube("lower", 5, 0.28, 0.05), cube("upper", 4, 0.25, -0.1)),
        (cube("lower", 6, 0.15, 0.15), cube("upper", 5, 0.2, 0.0)),
    ],
)
def test_an_arm_of_four_joints_stacks_boxes_without_a_pose_of_its_gripper(tmp_path, lower, upper):
    height = (float(lower.split("[")[1].split()[0]) + float(upper.split("[")[1].split()[0])) / 200
    result, _ = run(
        tmp_path,
        f"""
        - pick: upper
          expect: [{{lifted: {{object: upper, above: 5 cm}}}}]
        - place: {{object: upper, pose: {{frame: lower, xyz: [0, 0, {height}]}}}}
        - settle: {{}}
          expect: [{{on: {{object: upper, support: lower}}}}, {{released: upper}}]
        """,
        robot=OM,
        rest=objects(lower, upper),
    )
    assert result.outcome == "passed", (failures(result), [s.message for s in result.steps])


@pytest.mark.nightly(but=[1])
@pytest.mark.parametrize(
    ("robot", "where", "pitch"),
    [
        (OM, "0.2, 0.07, 0.03", ""),
        (OM, "0.2, 0.07, 0.03", ", pitch: 60 deg"),
        (UR5E, "0.5, 0.1, 0.03", ""),
    ],
)
def test_a_grasp_pose_without_rotation_leaves_the_rotation_to_the_arm(
    tmp_path, robot, where, pitch
):
    x, y, _ = where.split(", ")
    result, record = run(
        tmp_path,
        f"""
        - pick: {{object: cube, grasp_pose: {{xyz: [{where}]}}{pitch}, lift: {{distance: 5 cm}}}}
          expect: [{{lifted: {{object: cube, above: 4 cm}}}}]
        """,
        robot=robot,
        rest=objects(cube("cube", 4, x, y)),
    )
    assert result.outcome == "passed", (failures(result), [s.message for s in result.steps])
    assert record.steps[0].result.plain()["grasps"] == (1 if pitch else 7 if robot == OM else 4)


@pytest.mark.parametrize("rotation", ["rpy: [0, 0, 0]", "quat_xyzw: [0, 0, 0, 1]"])
def test_a_pitch_next_to_a_rotation_is_refused(tmp_path, rotation):
    found = problems(
        tmp_path,
        f"- pick: {{object: cube, grasp_pose: {{xyz: [0.2, 0, 0], {rotation}}}, pitch: 0}}",
        robot=OM,
        rest=objects(cube("cube", 4, 0.2, 0.0)),
    )
    assert [line for line, _ in found] == [5]
    assert "`pitch` goes with a `grasp_pose` without rotation" in found[0][1]


def test_a_pitch_for_an_arm_of_six_joints_is_refused(tmp_path):
    found = check(
        tmp_path,
        "- pick: {object: cube, pitch: 0}",
        robot=UR5E,
        rest=objects(cube("cube", 4, 0.5, 0.0)),
    ).problems
    assert [(problem.line, "fewer than six joints" in problem.message) for problem in found] == [
        (5, True)
    ]
    assert "`grasp_pose` with a rotation" in found[0].hint


@pytest.mark.nightly(but=[1])
@pytest.mark.parametrize(
    ("step", "words"),
    [
        (
            "{object: cube, grasp_pose: {xyz: [0.2, 0.05, 0.03], rpy: [0, 0, 0]}}",
            "leave the rotation out of `grasp_pose`",
        ),
        ("{object: cube, pitch: 0}", "give `approach` a shorter `distance`"),
        ("{object: far}", "bring 'far' or the robot's `base` nearer"),
        ("{object: far, pitch: 10 deg}", "leave out `pitch`"),
    ],
)
def test_advice_for_a_pick_names_keys_that_it_has(tmp_path, step, words):
    result, record = run(
        tmp_path,
        f"- pick: {step}",
        robot=OM,
        rest=objects(cube("cube", 4, 0.2, 0.05), cube("far", 4, 0.6, 0.2)),
    )
    assert result.outcome == "failed"
    assert words in advice(record)
    keys = re.findall(r"`(\w+)", advice(record))
    assert set(keys) <= {"grasp_pose", "pitch", "approach", "distance", "direction", "base"}


@pytest.mark.nightly(but=["10 deg-10\\xb0 below the horizontal"])
@pytest.mark.parametrize(
    ("pitch", "words"), [("10 deg", "10° below the horizontal"), ("90 deg", "straight down")]
)
def test_a_pick_out_of_reach_says_how_it_approaches(tmp_path, pitch, words):
    step = f"- pick: {{object: far, pitch: {pitch}}}"
    _, record = run(tmp_path, step, robot=OM, rest=objects(cube("far", 4, 0.6, 0.2)))
    assert record.steps[0].message.endswith(f", approached {words}")


@pytest.mark.nightly(but=["open_manipulator_x"])
@pytest.mark.parametrize("robot", [OM, UR5E])
def test_a_place_out_of_reach_gives_the_nearest_pose_and_that_one_is_reached(tmp_path, robot):
    (x, y), far = ((0.2, -0.05), "[0.3, 0.3, 0.04]") if robot == OM else ((0.5, -0.2), "[1, 1, 1]")
    words = {"robot": robot, "rest": objects(cube("cube", 4, x, y))}
    steps = "- pick: cube\n- place: {object: cube, pose: {xyz: WHERE}}"
    result, record = run(tmp_path, steps.replace("WHERE", far), **words)
    assert result.outcome == "failed"
    said = advice(record, "steps[1]")
    nearest = re.search(r"`pose: \{xyz: (\[[^]]*\])\}`, [0-9.]+ mm away", said)
    assert nearest, said
    assert not [step for step in record.steps if step.path.startswith("steps[1].")]


@pytest.mark.nightly
@pytest.mark.parametrize("padding", ["25 mm", "30 mm"])
def test_padding_does_not_apply_to_what_is_about_to_be_grasped(tmp_path, padding):
    result, _ = run(
        tmp_path,
        "- pick: {object: cube, lift: {distance: 5 cm}}\n"
        "  expect: [{lifted: {object: cube, above: 4 cm}}]",
        robot=UR5E,
        rest=f"planning: {{padding: {padding}}}\n" + objects(cube("cube", 8, 0.5, 0.1)),
    )
    assert result.outcome == "passed", [step.message for step in result.steps]


@pytest.mark.nightly
def test_padding_that_is_in_the_way_is_named_with_both_distances(tmp_path):
    """The floor keeps its padding; the cube to grasp does not."""
    result, record = run(
        tmp_path,
        "- pick: cube",
        robot=UR5E,
        rest="planning: {padding: 60 mm}\n" + objects(cube("cube", 4, 0.5, 0.1)),
    )
    assert result.outcome == "failed"
    assert "mm apart, 60.0 mm required)" in record.steps[0].message
    assert "only the `padding` of 60.0 mm is not kept" in advice(record)


@pytest.mark.nightly(but=[1])
@pytest.mark.parametrize(
    ("robot", "size", "opening", "words"),
    [
        (UR5E, "20 cm, 20 cm, 20 cm", "106.9 mm", "no side of it fits"),
        (UR5E, "20 cm, 15 cm, 5 cm", "106.9 mm", "its height of 50.0 mm fits"),
        (OM, "9 cm, 8.5 cm, 9 cm", "80.0 mm", "no side of it fits"),
    ],
)
def test_an_object_that_is_too_wide_is_compared_with_the_gripper(
    tmp_path, robot, size, opening, words
):
    result, record = run(
        tmp_path,
        "- pick: wide\n  expect_error: GOAL_STATE_INVALID",
        robot=robot,
        rest=objects(f"- {{name: wide, box: {{size: [{size}]}}, pose: {{xyz: [0.3, 0, 0.1]}}}}"),
    )
    assert result.outcome == "passed"
    assert "is too wide for the gripper: " in record.steps[0].message
    assert record.steps[0].message.endswith(f"the gripper opens to {opening}")
    assert words in advice(record)


@pytest.mark.nightly(but=[2, 1])
@pytest.mark.parametrize(
    ("robot", "shape", "least", "words"),
    [
        (UR5E, "box: {size: [20 cm, 6 mm, 10 cm]}", "13.6 mm", "its height of 100.0 mm fits"),
        (UR5E, "cylinder: {radius: 4 mm, length: 12 cm}", "13.6 mm", "no side of it fits"),
        (OM, "box: {size: [9 cm, 2 cm, 2 cm]}", "22.0 mm", "no side of it fits"),
    ],
)
def test_an_object_that_is_too_thin_is_compared_with_the_closed_gripper(
    tmp_path, robot, shape, least, words
):
    result, record = run(
        tmp_path,
        "- pick: thin\n  expect_error: GOAL_STATE_INVALID",
        robot=robot,
        rest=objects(f"- {{name: thin, {shape}, pose: {{xyz: [0.3, 0, 0.1]}}}}"),
    )
    assert result.outcome == "passed"
    assert "is too thin for the gripper: " in record.steps[0].message
    assert least in record.steps[0].message
    assert words in advice(record)


@pytest.mark.nightly
@pytest.mark.parametrize("turn", ["0", "30 deg", "90 deg"])
def test_a_plate_too_thin_to_hold_across_is_taken_across_its_wide_side(tmp_path, turn):
    pose = f"{{xyz: [0.5, 0.1, 0.05], rpy: [0, 0, {turn}]}}"
    result, _ = run(
        tmp_path,
        "- pick: plate\n  expect: [lifted: plate, grasped: plate]",
        robot=UR5E,
        rest=objects(f"- {{name: plate, box: {{size: [8 cm, 10 mm, 10 cm]}}, pose: {pose}}}"),
    )
    assert result.outcome == "passed", failures(result)


@pytest.mark.nightly
def test_a_load_too_heavy_to_hold_still_is_reported_with_torques(tmp_path):
    result, record = run(
        tmp_path,
        "- pick: heavy",
        robot=UR5E,
        rest="""
        objects:
          - name: heavy
            box: {size: [8 cm, 8 cm, 8 cm]}
            pose: {xyz: [0.5, 0.1, 0.04]}
            mass: 30
        """,
    )
    assert result.outcome == "failed"
    lift = next(step for step in record.steps if step.path == "steps[0].lift")
    assert re.search(
        r"cannot hold heavy \(30 kg\) still .* needs [0-9.]+ N m and has at most 150.0 N m",
        lift.message,
    )
    assert "no slower motion helps" in recorded_explanation(lift.explanation).advice


@pytest.mark.nightly
def test_nothing_is_put_down_where_the_gripper_cannot_open(tmp_path):
    """The open fingers are 117 mm wide."""
    length, half = 0.12, 0.06
    wall = (
        "- {name: wall, static: true, box: {size: [20 cm, 1 cm, 8 cm]},"
        " pose: {xyz: [0.22, 0, 0.04]}}"
    )
    sides = [
        f"{{box: {{size: [{length}, 5 mm, 4 cm]}}, pose: {{xyz: [0, {half}, 2 cm]}}}}",
        f"{{box: {{size: [{length}, 5 mm, 4 cm]}}, pose: {{xyz: [0, {-half}, 2 cm]}}}}",
        f"{{box: {{size: [5 mm, {length}, 4 cm]}}, pose: {{xyz: [{half}, 0, 2 cm]}}}}",
        f"{{box: {{size: [5 mm, {length}, 4 cm]}}, pose: {{xyz: [{-half}, 0, 2 cm]}}}}",
    ]
    bottom = f"{{box: {{size: [{length}, {length}, 5 mm]}}, pose: {{xyz: [0, 0, 2.5 mm]}}}}"
    shapes = ", ".join([bottom, *sides])
    bin_line = f"- {{name: bin, static: true, pose: {{xyz: [0.18, 0.12, 0]}}, shapes: [{shapes}]}}"
    result, record = run(
        tmp_path,
        "- pick: cube\n- place: {object: cube, pose: {frame: bin, xyz: [0, 0, 0.02]}}",
        robot=OM,
        rest=objects(cube("cube", 3, 0.2, -0.1), wall, bin_line),
    )
    assert result.outcome == "failed"
    step = next(step for step in record.steps if step.path == "steps[1]")
    assert step.error_code == "GOAL_IN_COLLISION"
    assert "the gripper has no room to open where 'cube' is put down" in step.message
    assert "farther from 'bin'" in advice(record, "steps[1]")


@pytest.mark.nightly
def test_the_advice_does_not_move_an_object_with_which_the_grasp_moves(tmp_path):
    """Following it had the same collision again: the palm stood as deep inside the post."""
    post = (
        "- {name: post, box: {size: [4 cm, 4 cm, 30 cm]}, pose: {xyz: [0.4, 0, 0.15]}, mass: 0.1}"
    )
    deep = "- pick: {object: post, grasp_pose: {xyz: [0, 0, -5 cm], frame: post}}"
    result, record = run(tmp_path, deep, robot=UR5E, rest=objects(post))
    assert result.steps[0].error_code == "GOAL_IN_COLLISION"
    said = advice(record, "steps[0]")
    assert "moving that does not help" in said
    assert "state another one with `grasp_pose`" in said


@pytest.mark.nightly
def test_the_first_length_of_an_approach_that_the_arm_can_follow_is_taken(tmp_path):
    """A shelf above leaves 6 cm."""
    result, _ = run(
        tmp_path,
        "- pick: {object: cube, lift: {distance: 3 cm}}\n"
        "  expect: [{lifted: {object: cube, above: 2 cm}}]",
        robot=UR,
        world="empty",
        rest=objects(
            "- {name: stand, static: true, box: {size: [0.3, 0.3, 1.02]},"
            " pose: {xyz: [0.3, 0.2, 0.51]}}",
            "- {name: cube, box: {size: [4 cm, 4 cm, 4 cm]}, pose: {xyz: [0.3, 0.2, 1.041]},"
            " mass: 0.05}",
        ),
    )
    assert result.outcome == "passed", [step.message for step in result.steps]


TABLE = "- {name: slab, static: true, box: {size: [0.3, 0.3, 0.2]}, pose: {xyz: [0.0, 0.0, 0.3]}}"


@pytest.mark.nightly(but=["- move_to: up"])
@pytest.mark.parametrize(
    "step",
    ["- pick: cube", "- move_to: up", "- move_to: {pose: {xyz: [0.4, 0.1, 0.4], rpy: [3, 0, 0]}}"],
)
def test_a_robot_that_starts_in_an_object_is_advised_to_move_that_object(tmp_path, step):
    found = check(tmp_path, step, robot=UR5E, rest=objects(cube("cube", 4, 0.5, 0.1), TABLE))
    (problem,) = found.predicted
    assert problem.message.startswith("START_STATE_IN_COLLISION")
    assert "what to do: move 'slab' out of the way" in "\n".join(found.explanations[0])


def test_a_robot_that_starts_in_the_ground_is_advised_to_raise_its_base(tmp_path):
    robot = "{model: ur5e, gripper: rh_p12_rn_a, base: {xyz: [0, 0, -0.3]}}"
    found = check(tmp_path, "- move_to: up", robot=robot)
    assert "what to do: raise the robot's `base`" in "\n".join(found.explanations[0])


@pytest.mark.nightly(but=["0.05"])
@pytest.mark.parametrize("depth", [0.02, 0.05, 0.1])
def test_the_ground_is_never_to_be_moved_away_from_what_lies_in_it(tmp_path, depth):
    sunk = cube("cube", 3, 0.2, 0.08).replace("0.015]", f"{-depth}]")
    found = check(tmp_path, "- pick: cube", robot=OM, rest=objects(sunk))
    text = "\n".join(found.explanations[0])
    assert "what to do: none of" in text
    assert "move 'cube'" in text
    assert "move 'ground_plane'" not in text
    assert "'ground_plane' out of the way" not in text


@pytest.mark.nightly(but=["True"])
@pytest.mark.parametrize("is_static", [True, False])
def test_only_what_is_not_static_is_to_be_moved_out_of_the_way(tmp_path, is_static):
    """Two walls leave no room for the fingers, whichever way they stand."""
    walls = [
        f"- {{name: wall_{number}, static: {str(is_static).lower()}, mass: 1,"
        f" box: {{size: {size}}}, pose: {{xyz: {xyz}}}}}"
        for number, (size, xyz) in enumerate([
            ("[10 cm, 2 cm, 6 cm]", "[0.2, 0.027, 0.03]"),
            ("[10 cm, 2 cm, 6 cm]", "[0.2, -0.027, 0.03]"),
            ("[2 cm, 3 cm, 6 cm]", "[0.227, 0, 0.03]"),
            ("[2 cm, 3 cm, 6 cm]", "[0.173, 0, 0.03]"),
        ])
    ]  # fmt: skip
    found = check(tmp_path, "- pick: cube", robot=OM, rest=objects(cube("cube", 3, 0.2, 0), *walls))
    text = "\n".join(found.explanations[0])
    assert "grasp is not free" in text or "is free: move 'cube'" in text
    assert ("out of the way" in text) != is_static


@pytest.mark.nightly(but=["- pick: {object: other, pitch: 80 deg}"])
@pytest.mark.parametrize("second", ["- pick: other", "- pick: {object: other, pitch: 80 deg}"])
def test_a_pick_with_a_full_gripper_is_advised_to_put_down_first(tmp_path, second):
    found = check(
        tmp_path,
        f"- pick: cube\n{second}",
        robot=OM,
        rest=objects(cube("cube", 3, 0.2, 0.08), cube("other", 5, 0.2, -0.08)),
    )
    text = "\n".join(found.explanations[0])
    assert "the gripper still holds 'cube': `place` or `release` it before this" in text


@pytest.mark.nightly(but=["open_manipulator_x"])
@pytest.mark.parametrize("robot", [OM, UR5E])
def test_a_place_after_a_pick_that_fails_is_no_second_problem(tmp_path, robot):
    steps = "- pick: cube\n- place: {object: cube, pose: {xyz: [0.2, 0.1, 0.02]}}"
    found = check(tmp_path, steps, robot=robot, rest=objects(cube("cube", 3, 3.0, 0.0)))
    (problem,) = found.predicted
    assert "NO_IK_SOLUTION" in problem.message


@pytest.mark.parametrize("robot", [OM, UR5E])
def test_a_place_before_its_pick_names_the_step_to_put_before_it(tmp_path, robot):
    steps = "- place: {object: cube, pose: {xyz: [0.2, 0.1, 0.02]}}\n- move_to: home"
    found = check(tmp_path, steps, robot=robot, rest=objects(cube("cube", 3, 0.3, 0.0)))
    assert "INVALID_OBJECT_NAME" in found.predicted[0].message
    assert "before: `- pick: cube`" in "\n".join(found.explanations[0])


def part(shape, height):
    """A part of a height [m] on the floor, where a UR3e takes it from above."""
    return objects(
        f"- {{name: part, {shape}, mass: 0.03, pose: {{xyz: [0.35, 0.1, {height / 2}]}}}}"
    )


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("shape", "height"),
    [
        ("box: {size: [2 cm, 2 cm, 2 cm]}", 0.02),
        ("box: {size: [25 mm, 3 cm, 1 cm]}", 0.01),
        ("cylinder: {radius: 15 mm, length: 25 mm}", 0.025),
        ("box: {size: [9 cm, 12 cm, 2 cm]}", 0.02),
    ],
)
def test_fingertips_that_swing_down_stay_above_what_a_small_part_stands_on(tmp_path, shape, height):
    """The tips of the RH-P12-RN(A) reach 28 mm farther out when they are closed."""
    words = {"robot": UR3E, "rest": part(shape, height)}
    assert not check(tmp_path, "- pick: part", **words).predicted
    steps = "- pick: part\n  expect: [{lifted: {object: part, above: 7 cm}}]"
    result, _ = run(tmp_path, steps, **words)
    assert result.outcome == "passed", (failures(result), [s.message for s in result.steps])


@pytest.mark.nightly
@pytest.mark.parametrize("size", [2, 3])
def test_fingers_that_press_the_floor_are_named_and_the_advice_to_grasp_higher_helps(
    tmp_path, size
):
    step = "- pick: {object: part, grasp_pose: {frame: part, xyz: [0, 0, %s]}}"
    words = {"robot": UR3E, "rest": objects(cube("part", size, 0.35, 0.1))}
    result, record = run(tmp_path, step % 0, **words)
    [failed] = [step for step in result.steps if step.verb == "grasp"]
    assert failed.error_code == "CONTROL_FAILED"
    assert re.search(r"the fingers press ground_plane with [\d.]+ N and [\d.]+ N", failed.message)
    given = advice(record, failed.path)
    found = check(tmp_path, step % 0, **words)
    assert "mm into ground_plane" in found.predicted[0].message
    assert given in "\n".join(found.explanations[0])
    higher = int(re.search(r"grasp it (\d+) mm higher", given)[1])
    result, _ = run(tmp_path, step % (higher / 1000), **words)
    assert result.outcome == "passed", [s.message for s in result.steps]
