"""What needs the robot and the world to be known: found before anything moves, all at once."""

import pytest

from harness.cell.program import step_seed
from harness.session.prepare import prepare
from tests.session.front_door import UR, file_of, problems

TEN = """
- move_to: {joints: {elbow: 1.0}}
- move_to: {pose: {frame: base_lnk, xyz: [0.3, 0, 0.3]}}
- move_to: mogi_hom
- move_to: up
  group: amr
- move_to: up
  planning: {planner_id: RRTConect}
- pick: gren_cylinder
- pick: Table
- attach_object: {object: red_box, link: nolink}
- move_object: {object: later, pose: {xyz: [0, 0, 2]}}
- add_object: {name: later, box: {size: [0.1, 0.1, 0.1]}}
- wait: 1 s
  id: same
- wait: 1 s
  id: same
- gripper: opn
- wait: 700 s
"""


def test_every_name_that_robot_and_world_do_not_have_is_reported_with_its_line(tmp_path):
    found = problems(tmp_path, TEN, world="lesson_ur", rest="expect: [{lifted: nothing}]")
    expected = {
        5: "'elbow'",
        6: "'base_lnk'",
        7: "'mogi_hom'",
        9: "'amr'",
        11: "'RRTConect'",
        12: "'gren_cylinder'",
        13: "'Table' is static: it cannot be picked up",
        14: "'nolink'",
        15: "'later'",
        20: "'same'",
        21: "'opn'",
        22: "the steps up to here request 702 s",
        23: "'nothing'",
    }
    assert [line for line, _ in found] == list(expected)
    assert all(expected[line] in message for line, message in found)


# A tetrahedron in metres, as a file in millimetres.
SPECK = "v 0 0 0\nv 1e-5 0 0\nv 0 1e-5 0\nv 0 0 1e-5\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


@pytest.mark.parametrize(
    ("steps", "message"),
    [
        ("- remove_object: red_box\n- pick: red_box", "'red_box' is not in the scene at this step"),
        (
            "- clear_objects: {world: true}\n- pick: red_box",
            "'red_box' is not in the scene at this",
        ),
        ("- detach_object: red_box", "'red_box' is not attached at this step"),
        ("- add_object: {name: red_box, box: {size: [1, 1, 1]}}", "another object is called"),
        (
            "- gripper: {position: 3}",
            "'rh_r1_joint' goes from -5.73 deg to 63.03 deg, not to 171.89 deg",
        ),
        (
            "- gripper: {width: 20 cm}",
            "the gap between the pads goes from 13.6 to 106.9 mm, not to 200.0 mm",
        ),
        (
            "- gripper: {width: 109 mm}",
            "the gap between the pads goes from 13.6 to 106.9 mm, not to 109.0 mm",
        ),
        (
            "- gripper: {width: 6 mm}",
            "the gap between the pads goes from 13.6 to 106.9 mm, not to 6.0 mm",
        ),
        ("- attach_object: {object: red_box, represents: cup}", "there is no object 'cup'"),
        (
            "- allow_collisions: {pairs: [[robot, Tabel]], during: [wait: 1]}",
            "there is no object or",
        ),
    ],
)
def test_what_is_said_at_the_wrong_place_is_reported(tmp_path, steps, message):
    ((_, found),) = problems(tmp_path, steps, world="lesson_ur")
    assert found.startswith(message)


def test_a_robot_without_a_gripper_can_grasp_nothing(tmp_path):
    steps = "- gripper: open\n- pick: red_box\n- place: {pose: {xyz: [0, 0, 1]}}"
    found = problems(tmp_path, steps, robot="{model: ur3e}", world="lesson_ur")
    assert found == [(5, "`gripper` needs a gripper, and ur3e has none")]


def test_objects_with_one_name_are_reported_in_scenario_and_world(tmp_path):
    (tmp_path / "own.yaml").write_text(
        "world: own\nobjects:\n- {name: cup, sphere: {radius: 0.1}}\n"
        "- {name: cup, plane: {}}\n- {name: pot, mesh: {file: pot.stl}, static: true}\n"
    )
    ball = "{name: ball, sphere: {radius: 0.1}}"
    rest = f"objects:\n- {ball}\n- {ball}\n"
    found = problems(tmp_path, "- wait: 1", world="own.yaml", rest=rest)
    assert found == [
        (
            3,
            "world 'own': two objects are called 'cup'; object 'cup': a plane has no mass: say"
            " `static: true`; object 'pot': there is no mesh file 'pot.stl' next to the file",
        ),
        (8, "another object is called 'ball'"),
    ]


def test_a_robots_mistake_is_reported_at_its_own_key(tmp_path):
    robot = "\n  model: ur3e\n  named_states: {arm: {mine: {elbow_joint: 0}}}"
    ((line, message),) = problems(tmp_path, "- wait: 1", robot=robot)
    assert line == 4
    assert message == "robot.named_states: 'ur3e' has no group 'arm'; groups: ur_manipulator"


def test_seeds_differ_by_step_and_follow_from_seed_and_place_alone(tmp_path):
    steps = "- wait: 1\n- wait: 1\n- allow_collisions: {pairs: [[robot, robot]], during: [wait: 1]}"

    def seeds(text, rest=""):
        program = prepare(file_of(tmp_path, text, rest=rest)).program
        return [step.options.seed for step in program.all_steps()]

    plain = seeds(steps)
    assert plain == [
        step_seed(0, path) for path in ("steps[0]", "steps[1]", "steps[2]", "steps[2].during[0]")
    ]
    assert len(set(plain)) == 4
    assert (
        seeds(steps.replace("- wait: 1\n", "- wait: 1\n  id: named\n  name: for people\n", 1))
        == plain
    )
    assert seeds(steps, rest="description: another\n") == plain
    assert not set(seeds(steps, rest="seed: 1\n")) & set(plain)


def test_a_step_overrides_the_scenarios_planning_key_by_key(tmp_path):
    text = "- move_to: up\n  planning: {planning_time: 2}\n- move_to: home"
    rest = "planning: {max_state_checks: 7, padding: 0.01, max_velocity_scaling_factor: 0.5}"
    first, second = prepare(file_of(tmp_path, text, robot=UR, rest=rest)).program.steps
    assert second.options.max_state_checks == 7
    assert first.options.max_state_checks > 1000
    assert first.options.padding == second.options.padding == 0.01
    assert first.options.velocity_scaling == 0.5


@pytest.mark.parametrize(
    ("file", "content", "reason"),
    [
        ("mug.dae", "<COLLADA/>", "mug.dae cannot be read: it is damaged or not in DAE format"),
        (
            "mug.stl",
            "solid nothing",
            "mug.stl has no triangles: it is empty, damaged or not in STL format",
        ),
        ("mug.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "mug.obj is flat"),
        ("mug.obj", SPECK, "mug.obj cannot be used: it is 0.01 mm large; state a larger `scale`"),
    ],
)
def test_a_mesh_that_cannot_be_used_is_reported_at_its_object(tmp_path, file, content, reason):
    (tmp_path / file).write_text(content)
    rest = f"objects:\n- {{name: mug, mesh: {{file: {file}}}, static: true}}\n"
    ((line, message),) = problems(tmp_path, "- wait: 1", rest=rest)
    assert line == 7
    assert message.startswith(f"object 'mug': {reason}")


def test_a_planners_parameters_are_checked_before_anything_is_planned(tmp_path):
    """A step's planner gets the scenario's parameters, where it has none of its own."""
    found = problems(
        tmp_path,
        """
        - move_to: up
          planning: {planner_id: PRM}
        - move_to: up
          planning: {planner_id: auto, parameters: {range: -1}}
        - move_to: up
          planning: {planner_id: PRM, parameters: {max_nearest_neighbors: 5}}
        """,
        rest="planning: {planner_id: RRTConnect, parameters: {range: 0.5, rnge: 1}}",
    )
    assert [(line, message.partition(" (")[0]) for line, message in found] == [
        (6, "planner PRM has no parameter 'range'"),
        (8, "planner parameter 'range' cannot be -1; it is a distance [rad]"),
        (11, "planner RRTConnect has no parameter 'rnge'"),
    ]
