"""Words of expectations are no names, and a value has the dimension of its joint or signal."""

import pytest

from tests.session.front_door import problems

ARM = "{model: open_manipulator_x, base: {xyz: [0, 0, 0.01]}}"
CUBE = "{name: %s, box: {size: [0.04, 0.04, 0.04]}, pose: {xyz: [0.3, 0.2, 0.021]}}"


def messages(folder, steps="- wait: 0.1 s", rest=""):
    return [message for _, message in problems(folder, steps, robot=ARM, rest=rest)]


@pytest.mark.parametrize("name", ["robot", "gripper", "any", "tcp"])
def test_no_object_has_the_name_of_a_word_of_expectations(name, tmp_path):
    for steps, rest in (
        ("- wait: 0.1 s", f"objects: [{CUBE % name}]"),
        (f"- add_object: {CUBE % name}", ""),
    ):
        [said] = messages(tmp_path, steps, rest)
        assert said.startswith(f"'{name}' is a word of expectations: ")


@pytest.mark.parametrize("name", ["robot_2", "tcp_marker", "anything", "Gripper"])
def test_names_that_only_resemble_such_words_are_names(name, tmp_path):
    assert messages(tmp_path, rest=f"objects: [{CUBE % name}]") == []


@pytest.mark.parametrize(
    ("name", "meaning"),
    [("any", "a word of"), ("world", "a robot link's"), ("link5", "a robot link's"),
     ("joint1", "a robot joint's")],
)  # fmt: skip
def test_no_object_of_a_file_or_a_world_has_a_name_that_means_something_else(
    name, meaning, tmp_path
):
    [said] = messages(tmp_path, rest=f"objects: [{CUBE % name}]")
    assert said.startswith(f"'{name}' is {meaning}")
    (tmp_path / "taken.yaml").write_text(f"world: taken\nobjects: [{CUBE % name}]\n")
    [(_, said)] = problems(tmp_path, "- wait: 0.1 s", robot=ARM, world="taken.yaml")
    assert f"'{name}' cannot be an object's name: it is {meaning}" in said


@pytest.mark.parametrize(
    ("expected", "is_right"),
    [
        ("joints: {positions: {joint1: 5 cm}}", False),
        ("joints: {positions: {joint1: 5 deg, joint2: 1 mm}}", False),
        ("joints: {positions: {gripper_left_joint: 5 deg}}", False),
        ("joints: {positions: {joint1: 5 deg, gripper_left_joint: 5 mm}}", True),
        ("gripper: {position: 5 deg}", False),
        ("gripper: {position: 5 mm, tolerance: 1 deg}", False),
        ("gripper: {position: 5 mm, tolerance: 1 mm}", True),
        ("gripper: {width: 2 cm, tolerance: 1 mm}", True),
        ("gripper: {width: 2 cm, tolerance: 1 deg}", False),
        ("formula: always position(joint1) < 5 cm", False),
        ("formula: always position(joint1) + 5 cm < 1", False),
        ("formula: always effort(joint1) < 5 N", False),
        ("formula: always abs(position(joint1)) < 90 deg", True),
        ("formula: always position(gripper_left_joint) < 1 cm", True),
        ("formula: always velocity(joint1) < 2", True),
    ],
)
def test_a_value_has_the_dimension_of_its_joint(expected, is_right, tmp_path):
    said = messages(tmp_path, rest=f"expect: [{{{expected}}}]" if "(" not in expected else
                    f"expect:\n  - {expected}\n")  # fmt: skip
    assert (said == []) == is_right, said
    assert all("is expected" in each or "joins" in each for each in said)


@pytest.mark.parametrize(
    ("goal", "is_right"),
    [("{joint1: 5 cm}", False), ("{joint1: 5 deg}", True), ("{joint1: 0.1}", True)],
)
def test_goals_of_joints_too(goal, is_right, tmp_path):
    assert (messages(tmp_path, f"- move_to: {{joints: {goal}}}") == []) == is_right


@pytest.mark.parametrize(
    ("expected", "is_possible"),
    [
        ("upright: {object: cube, tolerance: 5}", False),
        ("upright: {object: cube, tolerance: 5 deg}", True),
        ("in: {object: cube, container: bin, max_lean: 45}", False),
        ("in: {object: cube, container: bin, max_lean: 180 deg}", True),
        ("slip: {object: cube, max_rotation: 200 deg}", False),
        ("formula: always tilt(cube) < 90", False),
        ("formula: eventually 45 < tilt(cube)", False),
        ("formula: always tilt(cube) < 90 deg", True),
        ("formula: always tilt(cube) < 1.57", True),
    ],
)
def test_no_angle_between_two_directions_is_beyond_half_a_turn(expected, is_possible, tmp_path):
    container = (CUBE % "bin").replace("0.3", "0.5")
    rest = f"objects: [{CUBE % 'cube'}, {container}]\nexpect:\n  - {expected}\n"
    assert (messages(tmp_path, rest=rest) == []) == is_possible


@pytest.mark.parametrize(
    ("expected", "is_possible"),
    [
        ("joints: {positions: {joint1: 0}, tolerance: 100}", False),
        ("joints: {positions: {joint1: 0}, tolerance: 100 deg}", True),
        ("joints: {positions: {joint1: 0, joint2: 0}, tolerance: 2.5}", True),
        ("joints: {positions: {joint1: 0, joint2: 0}, tolerance: 5}", False),
        ("named_target: {state: home, tolerance: 10}", False),
        ("named_target: {state: home, tolerance: 10 deg}", True),
        ("gripper: {position: 5 mm, tolerance: 20 mm}", False),
        ("gripper: {position: 5 mm, tolerance: 10 mm}", True),
        ("gripper: {position: 5 mm}", True),
        ("gripper: {position: 21 mm}", True),
        ("never: {gripper: {position: 3 cm}}", False),
        ("never: {gripper: {width: 10}}", False),
        ("gripper: {width: 5 mm, tolerance: 20 cm}", False),
        ("never: {joints: {positions: {joint2: 1.6}}}", True),
        ("never: {joints: {positions: {joint1: 0, joint2: 90}}}", False),
    ],
)
def test_a_tolerance_leaves_positions_that_are_beyond_it(expected, is_possible, tmp_path):
    """joint1 turns by pi either way, joint2 by 1.5 rad; the fingers slide from -10 to 19 mm."""
    said = messages(tmp_path, rest=f"expect: [{{{expected}}}]")
    assert (said == []) == is_possible, said
    assert all("is decided without a run" in each for each in said)


@pytest.mark.parametrize(
    ("expected", "is_possible"),
    [
        ("grasped: {object: cube, max_slip: 5}", False),
        ("grasped: {object: cube, max_slip: 5 mm}", True),
        ("slip: {object: cube, max_distance: 100 cm}", False),
        ("inserted: {peg: cube, hole: cube, depth: 1 mm, tolerance: 2}", False),
        ("slip: {object: cube, max_distance: 0.9}", True),
        ("tcp_pose: {pose: {xyz: [0, 0, 1]}, tolerance: {position: 1}}", False),
        ("placed: {object: cube, pose: {xyz: [0, 0, 1]}, tolerance: {position: 10}}", False),
        ("clearance: {max_below_plan: 20}", False),
        ("gripper: {width: 2 cm, tolerance: 10 cm}", False),
        ("gripper: {width: 2 cm, tolerance: 3 cm}", True),
    ],
)
def test_no_error_of_a_length_is_allowed_that_only_millimetres_can_mean(
    expected, is_possible, tmp_path
):
    said = messages(tmp_path, rest=f"objects: [{CUBE % 'cube'}]\nexpect: [{{{expected}}}]")
    assert (said == []) == is_possible, said


@pytest.mark.parametrize(
    ("expected", "message"),
    [
        ("placed: {object: cube, tolerance: {position: 1 mm}}", "goes with `pose`"),
        ("in_contact: {between: [robot, cube], force_window: 1 ms}", "goes with `min_force`"),
        ("gripper: {stalled: true, tolerance: 1 mm}", "`tolerance` goes with `named_target` or"),
        ("within_limits: {position: false, velocity: false, effort: false}", "at least one kind"),
        ("formula: {formula: always x(cube) < 1, force_window: 1 ms}", "reads no force"),
        (
            "tcp_pose: {pose: {xyz: [0, 0, 1]}, position_only: true, tolerance: {orientation: 1}}",
            "says nothing with `position_only`",
        ),
    ],
)
def test_a_key_that_changes_no_verdict_is_refused(expected, message, tmp_path):
    [said] = messages(tmp_path, rest=f"objects: [{CUBE % 'cube'}]\nexpect: [{{{expected}}}]")
    assert message in said


@pytest.mark.parametrize(
    ("expected", "is_possible"),
    [
        ("placed: {object: cube, max_velocity: 5}", False),
        ("placed: {object: cube, max_velocity: 5 cm/s}", True),
        ("static: {max_velocity: 100 m/s}", False),
        ("static: {object: cube, max_angular_velocity: 50}", False),
        ("static: {object: cube, max_angular_velocity: 50 deg/s}", True),
    ],
)
def test_what_moves_fast_is_never_at_rest(expected, is_possible, tmp_path):
    said = messages(tmp_path, rest=f"objects: [{CUBE % 'cube'}]\nexpect: [{{{expected}}}]")
    assert (said == []) == is_possible, said


@pytest.mark.parametrize(
    ("expected", "is_possible"),
    [
        ("jerk: 1000000", False),
        ("jerk: {at_most: 100, window: 10 s}", False),
        ("jerk: 5000", True),
        ("duration: {at_least: 0}", False),
        ("duration: {at_least: 1 s}", True),
    ],
)
def test_a_limit_that_no_motion_of_the_arm_breaks_is_refused(expected, is_possible, tmp_path):
    """Joints move by 4.8 rad/s at most."""
    said = messages(tmp_path, rest=f"expect: [{{{expected}}}]")
    assert (said == []) == is_possible, said


@pytest.mark.parametrize(
    ("step", "has_effect"),
    [
        ("wait: 1 s", False),
        ("settle: 1 cm/s", False),
        ("gripper: open", False),
        ("repeat: {times: 2, steps: [{wait: 1 s}]}", False),
        ("remove_object: cube", False),
        ("move_to: home", True),
        ("pick: cube", True),
    ],
)
def test_planning_parameters_of_a_step_that_plans_nothing_are_refused(step, has_effect, tmp_path):
    text = f"- {{{step}, planning: {{padding: 3 mm}}}}"
    said = messages(tmp_path, text, rest=f"objects: [{CUBE % 'cube'}]")
    assert any("`planning` has no effect on" in each for each in said) != has_effect, said


@pytest.mark.parametrize(
    "step",
    [
        "release: {object: cube, named_target: open, position: 5 mm}",
        "pick: {object: cube, approach: {distance: 3 cm, max_distance: 5 cm}}",
        "place: {pose: {xyz: [0, 0.2, 1]}, retreat: {min_distance: 3 cm, distance: 3 cm}}",
        "move_to: {position: {xyz: [0.2, 0, 0.2]}, tolerance: {position: 5}}",
    ],
)
def test_a_step_takes_no_key_that_another_one_overrides(step, tmp_path):
    rest = f"objects: [{CUBE % 'cube'}]"
    assert len(messages(tmp_path, f"- {{{step}}}", rest=rest)) == 1


def test_a_number_of_a_formula_is_no_larger_than_any_other(tmp_path):
    for number, is_right in (("1e9", True), ("1.1e9", False), ("1e999", False)):
        said = messages(tmp_path, rest=f"expect:\n  - formula: always z(tcp) * {number} < 1e8\n")
        assert [f"{number} is too large" in each for each in said] == [True] * (not is_right)


def test_a_group_that_there_is_not_is_reported_on_every_step(tmp_path):
    for step in ("wait: 0.1 s", "settle: {}", "move_to: home"):
        found = messages(tmp_path, f"- {{{step}, group: ghost}}")
        assert any("planning group" in each and "ghost" in each for each in found), (step, found)


WORDS = ("displaced", "grasped", "in", "lifted", "on", "placed", "released", "static", "upright")


@pytest.mark.parametrize("word", WORDS)
def test_no_predicate_of_the_physics_is_judged_of_what_only_the_planner_knows(tmp_path, word):
    rest = f"""
    objects: [{{name: ghost, in: planning, sphere: {{radius: 1 cm}}, pose: {{xyz: [1, 1, 1]}}}}]
    expect: [{word}: {{object: ghost{MORE.get(word, "")}}}]
    """
    [(_, message)] = problems(tmp_path, "- wait: 1 s", robot="open_manipulator_x", rest=rest)
    assert "ghost" in message


MORE = {"in": ", container: ground_plane", "on": ", support: ground_plane"}


UNKNOWN = """\
expect:
  - clearance: {between: [robot, nowhere], at_least: 1 cm}
  - collision: {between: [gripper, nowhere]}
  - displaced: {object: nowhere, distance: 1 cm}
  - gripper: {named_target: nowhere}
  - in: {object: nowhere, container: floor}
  - in: {object: cube, container: nowhere}
  - in_contact: {between: [cube, nowhere]}
  - joints: {positions: {nowhere: 1 deg}}
  - named_target: {group: nowhere, state: init}
  - named_target: {group: arm, state: nowhere}
  - "on": {object: cube, support: nowhere}
  - placed: {object: cube, on: nowhere}
  - placed: {object: cube, pose: {xyz: [0, 0, 0], frame: nowhere}}
  - placed: {object: cube, pose: {xyz: [0, 0, 0]}, during: nowhere}
  - sees: {camera: nowhere, object: cube}
  - slip: {object: nowhere, less_than: 1 mm}
  - static: {object: nowhere}
  - tcp_path: {line: {start: {xyz: [0, 0, 0], frame: nowhere}, end: {xyz: [0, 0, 1]}}}
  - tcp_path: {line: {start: {xyz: [0, 0, 0]}, end: {xyz: [0, 0, 1], frame: nowhere}}}
  - tcp_pose: {link: nowhere, pose: {xyz: [0, 0, 0]}}
  - tcp_pose: {pose: {xyz: [0, 0, 0], frame: nowhere}}
  - upright: {object: nowhere}
"""


def test_an_expectation_refuses_every_name_that_means_nothing(tmp_path):
    rest = f"objects: [{CUBE % 'cube'}]\n{UNKNOWN}"
    found = problems(tmp_path, "- wait: 0.1 s", robot=ARM, rest=rest)
    lines = (tmp_path / "test.scenario.yaml").read_text(encoding="utf-8").splitlines()
    refused = {line for line, message in found if "'nowhere'" in message}
    assert refused == {number for number, line in enumerate(lines, 1) if "nowhere" in line}
