"""The bundled robots against the numbers of their makers."""

import math

import numpy as np
import pytest

from harness.robot.load import gripper_names, robot_names
from tests.robot.models import UR_TYPES, Arm, robot

UR_JOINTS = (
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
)
EVERY_ROBOT = [
    {"model": "open_manipulator_x"},
    {"gripper": "rh_p12_rn_a"},
    *({"model": name} for name in UR_TYPES),
    *({"model": name, "gripper": "rh_p12_rn_a"} for name in UR_TYPES),
]
NAMES = [" + ".join(spec.values()) for spec in EVERY_ROBOT]

# Pinocchio on the original URDF of tag 3.1.0; end_effector_link in link1.
OPEN_MANIPULATOR_X = [
    ((0.0, 0.0, 0.0, 0.0), (0.286, 0.0, 0.1875), 0.0),
    ((0.0, -1.0, 0.7, 0.3), (0.161721, 0.0, 0.185499), 0.0),
    ((0.0, -1.0, 1.0, 0.0), (0.167259, 0.0, 0.148854), 0.0),
    ((0.0, 0.87, -0.195, -0.67), (0.348116, 0.0, 0.045577), 0.005),
]

# Pinocchio on the URDF of ur_description 4.3.1: tool0 and TCP in base_link, quaternion xyzw.
UR = {
    "ur3e": [
        ("home", (0.085394, 0.22315, 0.608592), (0.085394, 0.34815, 0.608592), None),
        ("up", (6e-05, 0.22315, 0.69395), (6e-05, 0.34815, 0.69395), None),
        (
            "test_configuration",
            (-0.12009, 0.27046, 0.337794),
            (-0.11702, 0.251586, 0.214265),
            (0.996227, 0.040574, 0.009226, 0.076156),
        ),
        (
            "mogi_home",
            (0.307049, -0.131021, 0.529894),
            (0.415308, -0.131011, 0.467404),
            (-0.331442, 0.800067, -0.191334, 0.461986),
        ),
        ("mogi_down", (-0.548838, -0.131101, 0.0665), (-0.673838, -0.131112, 0.0665), None),
    ],
    "ur5e": [
        ("home", (0.099779, 0.2329, 0.97969), (0.099779, 0.3579, 0.97969), None),
        ("up", (9.8e-05, 0.2329, 1.0794), (9.8e-05, 0.3579, 1.0794), None),
        (
            "test_configuration",
            (-0.116614, 0.44926, 0.55917),
            (-0.113543, 0.430386, 0.435641),
            (0.996227, 0.040574, 0.009226, 0.076156),
        ),
        (
            "mogi_home",
            (0.475711, -0.133256, 0.820187),
            (0.58397, -0.133245, 0.757697),
            (-0.331442, 0.800067, -0.191334, 0.461986),
        ),
        ("mogi_down", (-0.916788, -0.133385, 0.0628), (-1.041788, -0.133396, 0.0628), None),
    ],
}
PRINTED = 6e-7  # half of the last printed digit, and a little

# Sum of the links that move [kg], ur_description 4.3.1.
MOVING_MASS = {
    "ur3": 8.63,
    "ur5": 17.0489,
    "ur10": 28.435,
    "ur3e": 8.7985,
    "ur5e": 17.7,
    "ur7e": 17.7,
    "ur10e": 29.104,
    "ur12e": 29.104,
    "ur16e": 27.26,
    "ur8long": 39.9439,
    "ur15": 36.2578,
    "ur18": 34.9517,
    "ur20": 60.96,
    "ur30": 59.147,
}
CAD_MASS_OF_GRIPPER = 0.23596993 + 2 * (0.068097065 + 0.021860528)


def mass(description, without=()):
    return sum(
        link.inertial.mass
        for link in description.links
        if link.inertial is not None and link.name not in without
    )


def test_every_type_of_the_family_is_a_model_name():
    assert set(UR_TYPES) == set(MOVING_MASS)
    grippers = ("rh_p12_rn_a", "suction_array", "suction_cup")
    assert set(robot_names()) == {"open_manipulator_x", *grippers, *MOVING_MASS}
    assert gripper_names() == grippers


@pytest.mark.parametrize(("positions", "xyz", "pitch"), OPEN_MANIPULATOR_X)
def test_open_manipulator_x_reaches_where_its_urdf_says(positions, xyz, pitch):
    arm = Arm(robot(model="open_manipulator_x"))
    named = {f"joint{index}": value for index, value in enumerate(positions, 1)}
    pose = arm.pose("end_effector_link", named, "link1")
    assert pose.translation == pytest.approx(xyz, abs=PRINTED)
    assert math.atan2(-pose.rotation[2, 0], pose.rotation[0, 0]) == pytest.approx(pitch, abs=1e-6)


@pytest.mark.parametrize("model", UR)
def test_ur_named_states_reach_where_the_official_urdf_says(model):
    description = robot(model=model, gripper="rh_p12_rn_a", base={"xyz": [0.1, 0.2, 1.02]})
    arm = Arm(description)
    states = description.states_of("ur_manipulator")
    for name, tool0, tcp, quat_xyzw in UR[model]:
        positions = states[name].positions
        at_tool0 = arm.pose("tool0", positions, "base_link")
        at_tcp = arm.pose("end_effector_link", positions, "base_link")
        assert at_tool0.translation == pytest.approx(tool0, abs=PRINTED), name
        assert at_tcp.translation == pytest.approx(tcp, abs=PRINTED), name
        if quat_xyzw is not None:
            x, y, z, w = quat_xyzw
            rotation = np.array(
                [
                    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
                ]
            )
            assert at_tcp.rotation == pytest.approx(rotation, abs=4e-6), name


def test_the_base_pose_moves_everything():
    here = Arm(robot(model="ur3e")).pose("tool0", {"elbow_joint": 1.0})
    there = Arm(robot(model="ur3e", base={"xyz": [1, 2, 3], "rpy": [0, 0, math.pi / 2]}))
    x, y, z = here.translation
    moved = there.pose("tool0", {"elbow_joint": 1.0}).translation
    assert moved == pytest.approx([1 - y, 2 + x, 3 + z], abs=1e-12)


@pytest.mark.nightly(but=["ur3e", "ur7e"])
@pytest.mark.parametrize("model", UR_TYPES)
def test_a_type_weighs_what_its_maker_says(model):
    alone = robot(model=model)
    mounted = robot(model=model, gripper="rh_p12_rn_a")
    assert mass(alone, {"base_link_inertia"}) == pytest.approx(MOVING_MASS[model], abs=1e-9)
    assert mass(mounted) - mass(alone) == pytest.approx(CAD_MASS_OF_GRIPPER, abs=1e-9)


@pytest.mark.nightly(but=["ur3e", "open_manipulator_x"])
@pytest.mark.parametrize("spec", EVERY_ROBOT, ids=NAMES)
def test_every_tensor_is_that_of_a_real_body(spec):
    for link in robot(**spec).links:
        if link.inertial is not None:
            smallest, middle, largest = np.linalg.eigvalsh(link.inertial.inertia)
            assert smallest > 0, link.name
            assert smallest + middle >= largest, link.name
            assert link.inertial.mass > 0, link.name


@pytest.mark.parametrize("spec", EVERY_ROBOT, ids=NAMES)
def test_every_joint_has_limits_from_a_named_source(spec):
    for joint in robot(**spec).movable_joints:
        assert np.isfinite([joint.lower, joint.upper, joint.velocity, joint.effort]).all()
        assert 0 < joint.effort < 1000, "the public URDFs' 1000 is a placeholder"
        assert joint.effort_source
        assert joint.acceleration > 0


@pytest.mark.parametrize("spec", EVERY_ROBOT, ids=NAMES)
def test_named_states_and_the_start_are_within_limits(spec):
    description = robot(**spec)
    states = [*(state.positions for state in description.named_states), description.start_state]
    for positions in states:
        for name, position in positions.items():
            joint = description.joint_by_name[name]
            assert joint.lower <= position <= joint.upper, name


@pytest.mark.parametrize("spec", EVERY_ROBOT, ids=NAMES)
def test_named_states_and_the_start_touch_nothing(spec):
    description = robot(**spec)
    arm = Arm(description)
    for state in description.named_states:
        assert arm.touching(state.positions) is None, state.name
    assert arm.touching(description.start_state) is None


def test_the_ur3e_has_the_lessons_limits_less_its_safety_margin():
    joints = robot(model="ur3e").joint_by_name
    limits = {name: (joints[name].lower, joints[name].upper) for name in UR_JOINTS}
    assert limits["shoulder_pan_joint"] == pytest.approx((-3.340658504, 3.340658504), abs=1e-9)
    for name in UR_JOINTS[1:5]:
        assert limits[name] == pytest.approx((-2.991592654, 2.991592654), abs=1e-9)
    assert limits["wrist_3_joint"] == pytest.approx((-6.133185307, 6.133185307), abs=1e-9)
    assert [joints[name].effort for name in UR_JOINTS] == [54, 54, 28, 9, 9, 9]


def test_safety_limits_can_be_switched_off_as_in_the_launch_file():
    joint = robot(model="ur5e", args={"safety_limits": False}).joint_by_name["elbow_joint"]
    assert joint.upper == pytest.approx(math.pi, abs=1e-9)


# Random configurations that touch themselves; with the recommended shapes, elsewhere: 0.096
# (OpenMANIPULATOR-X, within limits, 1500 samples), 0.353 and 0.253 (ur3e, ur5e, gripper, ±π, 600
# samples). Those same shapes give 0.393 and 0.274 in this check (3000 samples), the bundled ones
# 0.398 and 0.276: hence the tolerance.
@pytest.mark.nightly(but=["open_manipulator_x"])
@pytest.mark.parametrize(
    ("spec", "expected"),
    [
        ({"model": "open_manipulator_x"}, 0.096),
        ({"model": "ur3e", "gripper": "rh_p12_rn_a"}, 0.353),
        ({"model": "ur5e", "gripper": "rh_p12_rn_a"}, 0.253),
    ],
    ids=["open_manipulator_x", "ur3e", "ur5e"],
)
def test_shapes_touch_each_other_no_oftener_than_their_fit(spec, expected):
    description = robot(**spec)
    arm = Arm(description)
    rng = np.random.default_rng(2)
    joints = [
        description.joint_by_name[n] for n in description.groups[description.arm_group].joint_names
    ]
    if description.arm_group == "arm":
        joints.append(description.joint_by_name["gripper_left_joint"])
        low, high = (np.array([getattr(j, end) for j in joints]) for end in ("lower", "upper"))
    else:
        low, high = np.full(6, -np.pi), np.full(6, np.pi)
    samples = rng.uniform(low, high, (1000, len(joints)))
    names = [joint.name for joint in joints]
    hits = sum(arm.touching(dict(zip(names, q, strict=True))) is not None for q in samples)
    assert 0.5 * expected < hits / len(samples) < expected + 0.06


@pytest.mark.parametrize("model", UR_TYPES)
def test_no_type_is_in_touch_with_itself_most_of_the_time(model):
    arm = Arm(robot(model=model))
    samples = np.random.default_rng(5).uniform(-np.pi, np.pi, (150, 6))
    hits = sum(arm.touching(dict(zip(UR_JOINTS, q, strict=True))) is not None for q in samples)
    assert hits / len(samples) < 0.55
