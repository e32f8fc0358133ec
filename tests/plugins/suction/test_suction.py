"""Suction cups in scenario files: steps, verdicts with reasons, and files that are refused."""

import pytest

from tests.running import run_case

# The cup hangs over a plate on a table: its rim is 0.5 mm above the plate's top, at z = 0.2.
HEAD = """scenario: a cup
robot: {model: suction_cup, base: {xyz: [0, 0, 0.2705], rpy: [180 deg, 0, 0]}}
objects:
  - {name: table, static: true, box: {size: [0.4, 0.4, 0.1]}, pose: {xyz: [0, 0, 0.1]}}
"""
PLATE = "  - {name: plate, box: {size: [0.1, 0.1, 0.05]}, mass: %s, pose: {xyz: [%s, 0, 0.175]}}\n"


def run(folder, steps, expect="", *, mass=0.5, x=0.0, objects="", head=HEAD):
    path = folder / "cup.scenario.yaml"
    listed = "".join(f"  - {step}\n" for step in steps)
    expected = f"expect:\n{expect}" if expect else ""
    path.write_text(f"{head}{PLATE % (mass, x)}{objects}steps:\n{listed}{expected}")
    return run_case(path)


HOLDS = "  - grasped: plate\n  - released: plate\n"


def test_the_suction_is_switched_on_and_off(tmp_path):
    result = run(
        tmp_path,
        ["gripper: on", "remove_object: table", "wait: 0.3", "gripper: off", "wait: 0.3"],
        "  - eventually: {grasped: plate}\n  - eventually: {gripper: {named_target: on}}\n"
        "  - displaced: {object: plate, at_least: 10 cm}\n  - released: plate\n",
    )
    assert result.outcome == "passed", (result.problems, result.verdicts)


def test_a_grasp_attaches_and_a_release_lets_go(tmp_path):
    result = run(
        tmp_path,
        ["grasp: plate", "wait: 0.2", "release: plate", "wait: 0.1"],
        "  - {eventually: {grasped: plate}}\n  - released: plate\n  - slip: plate\n"
        "  - never: collision\n",
    )
    assert result.outcome == "passed", (result.problems, result.verdicts)
    assert [step.status for step in result.steps] == ["passed"] * 4


def test_a_rim_over_an_edge_says_how_much_of_it_touches(tmp_path):
    result = run(tmp_path, ["grasp: plate"], HOLDS, x=0.04)
    assert result.steps[0].error_code == "CONTROL_FAILED"
    assert "no suction cup holds 'plate': cup: 2 of 4 quarters of the rim touch" in (
        result.steps[0].message
    )
    assert "every cup needs a face under the whole of its rim" in result.steps[0].explanation[-1]
    result = run(tmp_path, ["gripper: on", "wait: 0.2"], "  - grasped: plate\n", x=0.04)
    [verdict] = result.verdicts
    assert verdict.status == "failed"
    assert "no suction cup holds plate: cup: 2 of 4 quarters of the rim touch" in verdict.reason


def test_a_cup_that_is_off_holds_nothing(tmp_path):
    [verdict] = run(tmp_path, ["wait: 0.2"], "  - grasped: plate\n").verdicts
    assert "no suction cup holds plate: the suction is off" in verdict.reason


def test_an_attachment_holds_nothing_where_the_cup_does_not(tmp_path):
    """The planner's belief alone: the naive check would see the plate attached to the tool."""
    result = run(
        tmp_path,
        ["attach_object: plate", "gripper: on", "remove_object: table", "wait: 0.2"],
        "  - grasped: plate\n  - lifted: plate\n",
        x=0.04,
    )
    assert [verdict.status for verdict in result.verdicts] == ["failed", "failed"]
    assert "though the planning scene has it attached" in result.verdicts[0].reason


@pytest.mark.parametrize(
    ("step", "options", "messages"),
    [
        ("grasp: plate", {"mass": 9}, ["'plate' weighs 88.2 N, and the suction cups hold at most"]),
        ("pick: plate", {"mass": "8 kg"}, ["'plate' weighs 78.4 N", "75.4 N"]),
        (
            "grasp: ball",
            {"objects": "  - {name: ball, sphere: {radius: 3 cm}, pose: {xyz: [0, 0, 0.18]}}\n"},
            ["'ball' is too small a sphere for the suction cup", "30.0 mm", "needs 52.0 mm"],
        ),
        (
            "pick: ball",
            {
                "head": HEAD.replace("suction_cup", "suction_array"),
                "objects": "  - {name: ball, sphere: {radius: 6 cm}, pose: {xyz: [0, 0, 0.21]}}\n",
            },
            ["'ball' is a sphere, and 4 suction cups do not close on one"],
        ),
        (
            "pick: stick",
            {
                "objects": "  - {name: stick, box: {size: [0.03, 0.03, 0.2]},"
                " pose: {xyz: [0.1, 0.1, 0.25]}}\n"
            },
            ["no face of 'stick' has room for the suction cups", "30.0 x 200.0 mm", "42.0 x 42.0"],
        ),
        (
            "grasp: {object: plate, mode: weld}",
            {},
            ["suction cups hold by their vacuum alone", "leave out `mode`"],
        ),
        ("pick: {object: plate, mode: weld}", {}, ["suction cups hold by their vacuum alone"]),
        ("gripper: {width: 2 cm}", {}, ["suction cups have no width", "`gripper: on`"]),
        (
            "gripper: open",
            {},
            ["there is no named state of gripper called 'open'", "known: off, on"],
        ),
    ],
)
def test_what_no_cup_can_hold_is_refused_where_it_stands(tmp_path, step, options, messages):
    result = run(tmp_path, [step], **options)
    text = "\n".join(f"{each.message}; {each.hint}" for each in result.problems)
    assert all(message in text for message in messages), text
    assert all(problem.line > 3 for problem in result.problems)


ARM = """scenario: an arm with a cup
robot: {model: ur3e, gripper: suction_cup}
objects:
  - {name: table, static: true, box: {size: [0.3, 0.3, 0.1]}, pose: {xyz: [0.35, 0, 0.05]}}
"""


@pytest.mark.nightly
@pytest.mark.parametrize("shape", ["box: {size: [5 cm, 6 cm, 7 cm]}", "cylinder: {radius: 3 cm,"
                                   " length: 7 cm}", "sphere: {radius: 55 mm}"])  # fmt: skip
def test_an_arm_picks_by_a_face_with_room(tmp_path, shape):
    z = 0.155 if "sphere" in shape else 0.135
    path = tmp_path / "arm.scenario.yaml"
    path.write_text(
        f"{ARM}  - {{name: thing, {shape}, mass: 0.4, pose: {{xyz: [0.35, 0.05, {z}]}}}}\n"
        "steps:\n  - pick: thing\nexpect:\n  - lifted: {object: thing, above: 5 cm}\n"
        "  - grasped: thing\n  - never: collision\n"
    )
    result = run_case(path)
    assert result.outcome == "passed", (result.steps, result.verdicts)


@pytest.mark.nightly
def test_a_load_that_hangs_at_rest_drops_when_it_is_accelerated(tmp_path):
    """A cup holds 75 N: 7 kg hang from it, and fall at the first upward jerk of 1.5 m/s^2."""
    push = "inject: {push: {plate: [0, 0, %s]}, push_duration: 0.1}"
    for force, holds in ((-5, True), (-12, False)):
        result = run(
            tmp_path,
            ["grasp: plate", "remove_object: table", "wait: 0.2", push % force, "wait: 0.2"],
            "  - grasped: plate\n",
            mass=7,
        )
        assert [each.status == "passed" for each in result.verdicts] == [holds], result.verdicts
