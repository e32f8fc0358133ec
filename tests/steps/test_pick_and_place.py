"""pick, place and lin, on objects and arms of several kinds, in the physics."""

import numpy as np
import pytest

from tests.robot.vessels import vessel, write_obj
from tests.session.front_door import UR, check, failures, run

OM = "{model: open_manipulator_x, base: {xyz: [0, 0, 1.02]}}"


@pytest.mark.nightly
def test_a_can_with_its_origin_at_the_foot_is_picked_and_placed(tmp_path):
    result, record = run(
        tmp_path,
        """
        - move_to: mogi_home
        - pick: coke_can_steel
          expect: [{lifted: {object: coke_can_steel, above: 9 cm}}]
        - place: {pose: {frame: base_link, xyz: [0.3, 0.05, -0.005]}}
        - settle: {}
          expect:
            - placed: {object: coke_can_steel, pose: {frame: base_link, xyz: [0.3, 0.05, -0.005]}}
        - place: {pose: {frame: base_link, xyz: [0.3, 0.05, -0.005]}}
          expect_error: INVALID_OBJECT_NAME
        - pick: beer_0
          expect_error: GOAL_STATE_INVALID
        """,
        robot=UR,
        world="lesson_ur",
        rest="expect: [{never: collision}]",
    )
    assert result.outcome == "passed", failures(result)
    children = [
        step.id for step in record.steps if step.path.startswith(("steps[1].", "steps[2]."))
    ]
    assert children == [
        *(f"steps[1].{part}" for part in ("open", "reach", "approach", "grasp", "lift")),
        *(f"steps[2].{part}" for part in ("reach", "lower", "release", "retreat")),
    ]
    messages = [step.message for step in record.steps if step.status == "expected error"]
    assert messages[0] == "nothing is held, so nothing can be placed"
    assert messages[1] == (
        "'beer_0' is too wide for the gripper: 110.0 mm across its narrowest level side, and the"
        " gripper opens to 106.9 mm"
    )


@pytest.mark.nightly
@pytest.mark.parametrize("turn", ["[90 deg, 0, 0]", "[0, 90 deg, 40 deg]"])
def test_a_lying_bar_is_taken_across_its_narrow_level_side(tmp_path, turn):
    result, _ = run(
        tmp_path,
        """
        - remove_object: [green_cylinder, coke_can_steel, red_box]
        - settle: {}
        - move_to: mogi_home
        - pick: {object: bar, lift: {distance: 5 cm}}
          expect: [{lifted: {object: bar, above: 4 cm}}]
        """,
        robot=UR,
        world="lesson_ur",
        rest=f"""
        objects:
          - name: bar
            shapes: [{{box: {{size: [4 cm, 5 cm, 12 cm]}}, pose: {{xyz: [0, 0, 6 cm]}}}}]
            pose: {{xyz: [0.25, 0.0, 1.041], rpy: {turn}}}
        """,
    )
    assert result.outcome == "passed", (failures(result), [s.message for s in result.steps])


@pytest.mark.nightly
@pytest.mark.parametrize("kind", ["mesh", "shapes"])
def test_what_is_no_simple_shape_is_taken_by_the_box_around_it(tmp_path, kind):
    """A square cup that stands on its foot, and two blocks on each other."""
    write_obj(tmp_path / "cup.obj", *vessel(sides=4, outer=0.035, inner=0.03, height=0.1))
    block = "{box: {size: [4 cm, 5 cm, 5 cm]}, pose: {xyz: [0, 0, %s]}}"
    shapes = f"shapes: [{block % '2.5 cm'}, {block % '7.5 cm'}]"
    result, record = run(
        tmp_path,
        """
        - move_to: mogi_home
        - pick: {object: cup, lift: {distance: 5 cm}}
          expect: [{lifted: {object: cup, above: 4 cm}}]
        """,
        robot=UR,
        rest=f"""
        objects:
          - {{name: stand, static: true, box: {{size: [20 cm, 20 cm, 1 m]}},
             pose: {{xyz: [0.3, 0, 0.5]}}}}
          - name: cup
            {"mesh: {file: cup.obj}" if kind == "mesh" else shapes}
            mass: 0.1
            pose: {{xyz: [0.3, 0, 1.0], rpy: [0, 0, 20 deg]}}
        """,
    )
    assert result.outcome == "passed", [step.message for step in result.steps]
    assert record.steps[1].result.plain()["grasps"] == 4


def test_an_object_that_leans_needs_a_grasp_pose(tmp_path):
    result, _ = run(
        tmp_path,
        "- pick: post\n  expect_error: INVALID_OBJECT_NAME",
        robot=UR,
        rest="""
        objects:
          - name: post
            box: {size: [0.04, 0.04, 0.1]}
            pose: {xyz: [0.3, 0, 1.3], rpy: [0.5, 0, 0]}
        """,
    )
    assert result.outcome == "passed"
    assert "'post' leans by 29 degrees" in result.steps[0].message


def test_an_arm_of_four_joints_follows_a_line_off_its_plane(tmp_path):
    """Its yaw follows from the point: the one it started with cannot be kept."""
    result, _ = run(
        tmp_path,
        """
        - move_to: {position: {frame: link1, xyz: [0.2, 0.05, 0.1]}, pitch: 0.3}
        - lin: {position: {frame: link1, xyz: [0.2, -0.03, 0.12]}}
          expect:
            - tcp_pose: {pose: {frame: link1, xyz: [0.2, -0.03, 0.12]}, position_only: true}
        """,
        robot=OM,
    )
    assert result.outcome == "passed", [step.message for step in result.steps]


@pytest.mark.nightly
def test_a_line_to_a_position_with_a_pitch_ends_at_that_pitch(tmp_path):
    result, record = run(
        tmp_path,
        """
        - move_to: mogi_home
        - lin: {position: {frame: base_link, xyz: [0.3, -0.1, 0.3]}, pitch: 60 deg}
        """,
        robot=UR,
    )
    assert result.outcome == "passed", [step.message for step in result.steps]
    x, y, z, w = (record.signals.tcp_pose[-1, i] for i in (4, 5, 6, 3))
    down = -2 * (x * z - w * y)  # of the link's x axis
    assert np.degrees(np.arcsin(down)) == pytest.approx(60, abs=0.1)


def test_a_grasp_that_misses_says_where_the_object_is(tmp_path):
    result, _ = run(
        tmp_path, "- grasp: red_box\n  expect_error: CONTROL_FAILED", robot=UR, world="lesson_ur"
    )
    assert result.outcome == "passed"
    assert "did not touch 'red_box' when the gripper closed" in result.steps[0].message
    assert "mm from the TCP, in the TCP's axes" in result.steps[0].message


def test_what_stays_attached_to_the_end_is_not_released(tmp_path):
    result, _ = run(
        tmp_path,
        "- attach_object: red_box\n- wait: 0.1 s",
        robot=UR,
        world="lesson_ur",
        rest="expect: [{released: red_box}, {placed: red_box}]",
    )
    first, second = failures(result)
    assert first.endswith("attached in the planning scene at t=0.100 s")
    assert "attached in the planning scene" in second


@pytest.mark.nightly
def test_a_welded_grasp_says_so_in_its_verdicts(tmp_path):
    """Without friction nothing could be lifted: the report must show what held it."""
    result, _ = run(
        tmp_path,
        """
        - move_to: mogi_home
        - pick: {object: soap, mode: weld}
          expect: [{lifted: {object: soap, above: 9 cm}}, {grasped: soap}]
        """,
        robot=UR,
        world="lesson_ur",
        rest="""
        objects:
          - name: soap
            box: {size: [4 cm, 4 cm, 10 cm]}
            friction: 0
            pose: {xyz: [0.3, -0.3, 1.066]}
        """,
    )
    assert result.outcome == "passed", failures(result)
    assert all("welded to the hand by `mode: weld`" in v.reason for v in result.verdicts)


@pytest.mark.nightly
def test_what_was_welded_falls_when_it_is_detached(tmp_path):
    """A weld that outlived its attachment would let it hover, and `released` pass."""
    result, _ = run(
        tmp_path,
        """
        - move_to: mogi_home
        - pick: {object: green_cylinder, mode: weld}
        - gripper: open
          expect: [{never: {placed: green_cylinder}}]
        - detach_object: green_cylinder
        - settle: {}
          expect: [{released: green_cylinder}, {placed: {object: green_cylinder, on: Table_0}}]
        """,
        robot=UR,
        world="lesson_ur",
    )
    assert result.outcome == "passed", failures(result)


KNOCKED = """
objects:
  - {name: bottle, cylinder: {radius: 0.03, length: 0.2}, mass: 0.3, pose: {xyz: [0.7, 0.7, 0.1]}}
  - {name: puck, cylinder: {radius: 0.03, length: 0.05}, mass: 0.1, friction: 0.05,
     pose: {xyz: [1, 0.7, 0.025]}}
expect: [{never: collision}]
"""


@pytest.mark.nightly
@pytest.mark.parametrize("again", ["", "- detach_object: bottle\n- attach_object: bottle\n"])
def test_a_weld_that_failed_holds_nothing(tmp_path, again):
    """What the planner alone believes to be held may be knocked over without a collision."""
    steps = (
        "- grasp: {object: bottle, mode: weld}\n  expect_error: CONTROL_FAILED\n"
        f"- attach_object: bottle\n{again}"
        "- inject: {push: {puck: [-4, 0, 0]}, push_duration: 50 ms}\n- wait: 0.5 s"
    )
    robot = "{model: ur3e, gripper: rh_p12_rn_a, base: {xyz: [0, 0, 0.3]}}"
    result, record = run(tmp_path, steps, robot=robot, rest=KNOCKED)
    assert ("bottle", "puck") in record.signals.contact_forces
    assert failures(result) == []


@pytest.mark.nightly(but=["gripper: open-True"])
@pytest.mark.parametrize(("lets_go", "hits"), [("release: red_box", False),
                                               ("gripper: open", True)])  # fmt: skip
def test_a_weld_holds_until_a_step_releases_it(tmp_path, lets_go, hits):
    """The box falls onto a ball while the fingers still open; with `gripper` the weld holds it."""
    steps = f"""
    - gripper: open
    - move_to: {{position: {{xyz: [0.2, 0, 0.06]}}, pitch: 0}}
    - lin: {{position: {{xyz: [0.25, 0, 0.06]}}, pitch: 0}}
    - grasp: {{object: red_box, mode: weld}}
    - move_relative: {{direction: {{xyz: [0, 0, 1]}}, distance: 4 cm}}
    - add_object: {{name: ball, static: true, in: simulation, sphere: {{radius: 0.01}},
                   pose: {{xyz: [0.25, 0, 0.028]}}}}
    - {{{lets_go}, id: open}}
    - move_relative: {{direction: {{xyz: [0, 0, -1]}}, distance: 5 mm}}
    """
    rest = """
    objects:
      - {name: red_box, box: {size: [0.03, 0.03, 0.08]}, mass: 0.05, pose: {xyz: [0.25, 0, 0.04]}}
    expect: [{never: {collision: {between: [red_box, ball]}}}]
    """
    result, record = run(
        tmp_path, steps, robot="{model: open_manipulator_x, base: {xyz: [0, 0, 0.01]}}", rest=rest
    )
    assert ("ball", "red_box") in record.signals.contact_forces
    assert [verdict.status for verdict in result.verdicts] == ["failed" if hits else "passed"]


PLATES = "[0.06, 0.01, 0.13]", "0.25, 0.02", "0.25, -0.12"


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("shape", "grasps", "taken"),
    [
        ("box: {size: [4 cm, 5 cm, 12 cm]}", 4, 1),
        ("box: {size: [5 cm, 4 cm, 12 cm]}", 4, 3),
        ("cylinder: {radius: 2 cm, length: 12 cm}", 8, 3),
        ("box: {size: [12 cm, 4 cm, 12 cm]}", 2, 0),
    ],
)
def test_a_grasp_that_is_blocked_is_taken_another_way(tmp_path, shape, grasps, taken):
    """Plates that the planner alone knows stand where fingers would go."""
    size, *places = PLATES
    added = "".join(
        f"""
            - name: {name}
              box: {{size: {size}}}
              pose: {{frame: base_link, xyz: [{place}, 0.07]}}
              in: planning"""
        for name, place in zip(("plate", "other_plate"), places, strict=True)
    )
    result, record = run(
        tmp_path,
        f"""
        - remove_object: [green_cylinder, coke_can_steel, red_box]
        - settle: {{}}
        - move_to: mogi_home
        - move_to: {{pose: {{frame: base_link, xyz: [0.25, -0.05, 0.3], rpy: [180 deg, 0, 0]}}}}
        - add_object:{added}
        - pick: {{object: thing, lift: {{distance: 5 cm}}}}
          expect: [{{lifted: {{object: thing, above: 4 cm}}}}]
        """,
        robot=UR,
        world="lesson_ur",
        rest=f"""
        objects:
          - {{name: thing, {shape}, pose: {{frame: base_link, xyz: [0.25, -0.05, 0.06]}}}}
        """,
    )
    step = record.steps[5]
    assert step.result.plain()["grasps"] == grasps
    assert step.result.plain()["grasp"] == max(taken, 1)
    assert result.outcome == ("passed" if taken else "failed"), failures(result)


@pytest.mark.nightly(but=["0.046-2"])
@pytest.mark.parametrize(("width", "touching"), [(0.046, 2), (0.040, 0)])
def test_what_the_hand_overlaps_at_the_start_is_a_note_although_it_opens_first(
    tmp_path, width, touching
):
    box = f"{{name: box, box: {{size: [0.02, {width}, 0.02]}}, pose: {{xyz: [0.286, 0, 0.188]}}}}"
    found = check(
        tmp_path,
        "- pick: {object: box}",
        robot="open_manipulator_x",
        rest=f"objects: [{box}]",
    )
    overlaps = [note for note in found.notes if "and box overlap by 2 mm" in note]
    assert len(overlaps) == touching


STANDING_AT = "{frame: base_link, xyz: [0.28, -0.1, 0.055]"


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("shape", "stated", "turns", "taken"),
    [
        ("cylinder: {radius: 2 cm, length: 12 cm}", "", 8, 2),
        ("box: {size: [4 cm, 4 cm, 12 cm]}", "", 4, 2),
        ("cylinder: {radius: 2 cm, length: 12 cm}", ", rpy: [0, 0, 0]", 1, 0),
    ],
)
def test_what_looks_the_same_turned_is_placed_where_one_turn_is_blocked(
    tmp_path, shape, stated, turns, taken
):
    """Plates that the planner alone knows stand where fingers would go."""
    added = "".join(
        f"""
            - name: {name}
              box: {{size: [0.06, 0.01, 0.13]}}
              pose: {{frame: base_link, xyz: [0.28, {y}, 0.07]}}
              in: planning"""
        for name, y in (("plate", -0.03), ("other_plate", -0.17))
    )
    placed = f"pose: {STANDING_AT}{stated}}}"
    result, record = run(
        tmp_path,
        f"""
        - remove_object: [green_cylinder, coke_can_steel, red_box]
        - settle: {{}}
        - move_to: mogi_home
        - pick: thing
        - add_object:{added}
        - place: {{{placed}}}
        - settle: {{}}
          expect:
            - placed: {{object: thing, {placed}, tolerance: {{position: 5 mm, orientation: 2 deg}}}}
        """,
        robot=UR,
        world="lesson_ur",
        rest=f"""
        objects:
          - {{name: thing, {shape}, pose: {{frame: base_link, xyz: [0.25, -0.3, 0.056]}}}}
        """,
    )
    step = next(step for step in record.steps if step.verb == "place")
    assert step.result.plain()["turns"] == turns
    assert step.result.plain()["turn"] == max(taken, 1)
    assert result.outcome == ("passed" if taken else "failed"), failures(result)
