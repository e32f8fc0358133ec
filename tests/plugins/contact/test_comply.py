"""comply: springs, stated wrenches and free motions against theory; what no torque can give."""

import numpy as np
import pytest

import harness
from harness.core.kinematics import LinkPoses
from harness.plugins.contact.steps.comply import Yielded
from harness.session.check import check_file
from tests.simulation.test_pushing import GANTRY

SCENARIO = """
scenario: comply
robot: {robot}
objects:
  - {{name: block, static: true, box: {{size: [0.3, 0.3, 0.1]}}, pose: {{xyz: {block}}},
      friction: 0.1}}
steps:
{steps}
"""
GANTRY_ROBOT = "{mjcf: gantry.xml, tcp_link: tip}"
OMX = "open_manipulator_x"
ONTO = """
  - comply:
      stiffness: {z: %s}
      during:
        - allow_collisions:
            pairs: [[robot, block]]
            during:
              - move_relative: {direction: {xyz: [0, 0, -1]}, distance: 5 cm}
                id: down
              - wait: 0.3
                id: press
"""
PRESS = """
  - comply:
      wrench: {z: -10 N}
      during:
        - {wait: 1.5, id: press}
    id: comply
  - {wait: 0.3, id: after}
"""


def run_of(folder, steps, robot=GANTRY_ROBOT, block="[0.1, 0, 0.05]"):
    (folder / "gantry.xml").write_text(GANTRY, encoding="utf-8")
    file = folder / "comply.scenario.yaml"
    file.write_text(SCENARIO.format(robot=robot, block=block, steps=steps), encoding="utf-8")
    return harness.run(file)


def commanded_tcp(run, row):
    """Where the TCP is commanded to be at a sample."""
    commands = run.signals.joint_commands[row]
    positions = np.where(np.isnan(commands), run.signals.joint_positions[row], commands)
    poses = LinkPoses(run.robot.joints, positions[None], [run.robot.tcp_link])
    return poses.translations[run.robot.tcp_link][0]


def pressed_on(run, row, name="block"):
    return sum(force[row] for pair, force in run.signals.contact_forces.items() if name in pair)


START = "  - move_to: {joints: {x: 0.1, y: 0, z: 0}}"


@pytest.mark.nightly(but=["2000"])
@pytest.mark.parametrize("stiffness", [200, 2000])
def test_a_spring_presses_with_its_stiffness_times_the_distance(tmp_path, stiffness):
    result = run_of(tmp_path, START + ONTO % f"{stiffness} N/m")
    assert result, str(result)
    row = result.step("press").end_index - 1
    lag = result.run.signals.tcp_pose[row, 2] - commanded_tcp(result.run, row)[2]
    assert 0.01 < lag < 0.05
    assert pressed_on(result.run, row) == pytest.approx(stiffness * lag, rel=0.02)


def test_a_stated_force_is_what_presses_and_the_arm_stays_where_it_was_afterwards(tmp_path):
    result = run_of(tmp_path, START.replace("z: 0", "z: -0.02") + PRESS)
    assert result, str(result)
    run, step = result.run, result.step("press")
    force = pressed_on(run, slice(step.end_index - 200, step.end_index))
    assert force == pytest.approx(10, rel=0.02)
    z = run.signals.tcp_pose[:, 2]
    falls = np.abs(np.diff(z[step.start_index : step.end_index])) / run.timestep
    assert falls.max() < 0.022, "it moves at 2 cm/s before it touches"
    after = result.step("after")
    assert np.ptp(z[after.start_index : after.end_index]) < 2e-4
    assert result.step("comply").result.find(Yielded).effort_share < 1


@pytest.mark.nightly
def test_a_free_motion_follows_its_path(tmp_path):
    steps = """
  - comply:
      stiffness: {x: 500, y: 500}
      during:
        - move_relative: {direction: {xyz: [1, 1, 0.5]}, distance: 10 cm}
          id: free
"""
    result = run_of(tmp_path, START + steps)
    assert result, str(result)
    step, signals = result.step("free"), result.run.signals
    rows = slice(step.start_index, step.end_index)
    lag = np.abs(signals.joint_positions[rows] - signals.joint_commands[rows])
    assert lag.max() < 2e-4
    yielded = result.step("steps[1]").result.find(Yielded)
    assert np.array(yielded.largest_deviation[:3]) == pytest.approx(lag.max(axis=0), abs=1e-4)


@pytest.mark.nightly
@pytest.mark.parametrize("axes", ["x: 1000", "x: 1000, z: 3000"])
def test_the_axes_of_an_object_are_those_in_which_springs_act(tmp_path, axes):
    """A wall that is turned by 30 degrees: the spring along its normal alone gives way."""
    steps = (
        START
        + f"""
  - comply:
      frame: block
      stiffness: {{{axes}}}
      during:
        - allow_collisions:
            pairs: [[robot, block]]
            during:
              - move_relative: {{direction: {{xyz: [1, 0, 0], frame: block}}, distance: 8 cm}}
              - {{wait: 0.3, id: press}}
"""
    )
    block = "[0.28, 0.104, 0.3], rpy: [0, 0, 30 deg]"
    result = run_of(tmp_path, steps, block=block)
    assert result, str(result)
    row = result.step("press").end_index - 1
    turn = np.array(
        [[np.cos(np.pi / 6), np.sin(np.pi / 6)], [-np.sin(np.pi / 6), np.cos(np.pi / 6)]]
    )
    lag = (commanded_tcp(result.run, row) - result.run.signals.tcp_pose[row, :3])[:2]
    along, across = turn @ lag
    force = pressed_on(result.run, row)
    assert force > 5
    assert force == pytest.approx(1000 * along, rel=0.03)
    assert abs(across) < 0.1 * along


HELD = """
scenario: held
robot: {model: ur3e, gripper: rh_p12_rn_a}
objects:
  - name: cylinder
    mass: 0.3
    cylinder: {radius: 2 cm, length: 10 cm}
    pose: {xyz: [0.35, 0.1, 0.05]}
steps:
  - pick: cylinder
  - comply:
      stiffness: {x: 300, y: 300, z: 300, rx: 20, ry: 20, rz: 20}
      during:
        - {wait: 0.5, id: hang}
"""


@pytest.mark.nightly
def test_the_weight_of_what_is_held_is_compensated(tmp_path):
    """Springs of 300 N/m would yield by 10 mm under 0.3 kg."""
    file = tmp_path / "held.scenario.yaml"
    file.write_text(HELD, encoding="utf-8")
    result = harness.run(file)
    assert result, str(result)
    row = result.step("hang").end_index - 1
    sag = commanded_tcp(result.run, row) - result.run.signals.tcp_pose[row, :3]
    assert np.abs(sag).max() < 3e-4


@pytest.mark.parametrize(
    ("robot", "words", "said"),
    [
        (GANTRY_ROBOT, "stiffness: {rx: 20}", ["cannot move 'tip' about x"]),
        (GANTRY_ROBOT, "wrench: {z: -10, rz: 1}", ["8:35", "about z"]),
        (OMX, "frame: end_effector_link, stiffness: {rx: 2}", ["cannot move", "about x"]),
        (OMX, "frame: end_effector_link, stiffness: {y: 50}", ["cannot move", "along y"]),
        (GANTRY_ROBOT, "wrench: {z: 2 kN}", ["times the effort limit", "'z'"]),
        (GANTRY_ROBOT, "stiffness: {z: 100}, wrench: {z: 5}", ["`z` has a `stiffness` and a"]),
        (GANTRY_ROBOT, "stiffness: {}", ["no axis is named"]),
        (GANTRY_ROBOT, "damping: {z: 5}", ["`stiffness` and `wrench`"]),
        (GANTRY_ROBOT, "stiffness: {z: 0}", ["stiffness"]),
        (GANTRY_ROBOT, "stiffness: {z: 5 N}", ["a stiffness is expected"]),
        (GANTRY_ROBOT, "stiffness: {z: 5}, frame: blokc", ["`block`"]),
        (GANTRY_ROBOT, "stiffness: {z: 5}, link: tpi", ["`tip`"]),
    ],
)
def test_a_compliance_that_no_torque_can_give_is_a_located_error(tmp_path, robot, words, said):
    steps = f"  - comply: {{{words}, during: [{{wait: 0.1}}]}}"
    result = run_of(tmp_path, steps, robot, "[0.5, 0.5, 0.05]")
    assert result.case.outcome == "invalid", str(result)
    assert "comply.scenario.yaml:8:" in str(result)
    for each in said:
        assert each in str(result)


UR5E = "ur5e"


@pytest.mark.parametrize(
    ("robot", "step", "said"),
    [
        (UR5E, "comply: {stiffness: {z: 100 MN/m}", "the stiffness along z is 1e+08 N/m"),
        (UR5E, "comply: {stiffness: {ry: 1 MN*m/rad}", "the stiffness about y is 1e+06 N m/rad"),
        (UR5E, "comply: {wrench: {x: 0}, damping: {x: 1e5}", "the damping along x is 1e+05 N s/m"),
        (UR5E, "comply: {wrench: {z: -20 kN}", "times the effort limit of a joint"),
        (UR5E, "comply: {wrench: {y: 3 kN}", "times the effort limit of a joint"),
        (UR5E, "comply: {wrench: {rx: 900}", "times the effort limit of a joint"),
        (GANTRY_ROBOT, "comply: {stiffness: {z: 5000 kN/m}", "along z is 5e+06 N/m, and torques"),
        (GANTRY_ROBOT, "comply: {wrench: {z: 1}, damping: {rx: 5}", "cannot move 'tip' about x"),
    ],
)
def test_what_no_torque_gives_in_any_posture_is_located_though_singular_ones_bear_all(
    tmp_path, robot, step, said
):
    """A stretched arm bears any force along itself; its torques do not control it there."""
    result = run_of(tmp_path, f"  - {step}, during: [{{wait: 0.1}}]}}", robot, "[0.5, 0.5, 0.05]")
    assert result.case.outcome == "invalid", str(result)
    assert "comply.scenario.yaml:8:" in str(result)
    assert said in str(result)


def test_a_guarded_move_to_a_force_that_no_posture_can_press_is_a_located_error(tmp_path):
    step = "  - move_until: {direction: {xyz: [0, 0, -1]}, max_distance: 5 cm, force: %s}"
    for robot, force in ((UR5E, "20 kN"), (OMX, "400 N"), (GANTRY_ROBOT, "2 kN")):
        result = run_of(tmp_path, step % force, robot, "[0.5, 0.5, 0.05]")
        assert "comply.scenario.yaml:8:75: in every posture that was tried, the" in str(result)


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("stiffness: {z: 500 kN/m}", "here the stiffness along z is 5e+05 N/m, and torques in a"),
        ("wrench: {z: -300 N}", "here the wrench takes 1.07 times the effort limit of a joint"),
    ],
)
def test_what_no_torque_gives_where_the_arm_is_fails_and_check_predicts_it(tmp_path, words, said):
    steps = (
        "  - move_to: {pose: {xyz: [0.5, 0.1, 0.3], rpy: [180 deg, 0, 0]}}\n"
        f"  - comply: {{{words}, during: [{{wait: 0.1}}]}}"
    )
    result = run_of(tmp_path, steps, UR5E, "[0.5, 0.5, 0.05]")
    assert f"CONTROL_FAILED: {said}" in str(result)
    predicted = check_file(tmp_path / "comply.scenario.yaml").predicted
    assert [(each.line, said in each.message) for each in predicted] == [(9, True)]


@pytest.mark.nightly
def test_a_force_that_an_arm_has_is_pressed_though_no_cycle_damps_it_to_2_cm_s(tmp_path):
    """100 N over 2 cm/s is more damping than 1 ms holds for 4 kg: the arm comes faster."""
    steps = """
  - move_to: {pose: {xyz: [0.5, 0.1, 0.12], rpy: [180 deg, 0, 0]}}
  - allow_collisions:
      pairs: [[robot, block]]
      during:
        - comply: {wrench: {z: -100 N}, during: [{wait: 1.5, id: press}]}
"""
    result = run_of(tmp_path, steps, UR5E, "[0.5, 0.1, 0.05]")
    assert result, str(result)
    end = result.step("press").end_index
    assert pressed_on(result.run, slice(end - 200, end)) == pytest.approx(100, rel=0.02)
