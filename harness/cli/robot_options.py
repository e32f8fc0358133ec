"""Options that say which robot a command is about."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from harness.cli.arguments import pair

if TYPE_CHECKING:
    from harness.robot.robot_source import RobotSource

ROBOT = "a bundled name; a URDF, xacro, MJCF or SDF, also as package://name/path; a robot's folder"


def add_robot_options(command: argparse.ArgumentParser) -> None:
    """Add what goes with a robot's file."""
    add = command.add_argument
    text = "read groups, states and allowed pairs from this SRDF"
    add("--srdf", metavar="FILE", default="", help=text)
    text = "find package:// paths in this folder, and allow meshes to be read there"
    add("--package-path", metavar="DIR", action="append", default=[], help=text)
    text = "mount this bundled gripper, or name the SRDF group of the arm's own one"
    add("--gripper", metavar="NAME", default="", help=text)
    text = "set an argument of a xacro file"
    add("--args", metavar="NAME=VALUE", action="append", type=_argument, default=[], help=text)
    add("--group", metavar="NAME", default="", help="the SRDF group of the arm")
    add("--tcp-link", metavar="LINK", default="", help="the link at the tool centre point")


def source_of(arguments: argparse.Namespace) -> RobotSource:
    """Which robot the options say."""
    from harness.robot.robot_source import RobotSource

    return RobotSource(
        arguments.robot,
        srdf=arguments.srdf,
        packages=tuple(arguments.package_path),
        gripper=arguments.gripper,
        args=dict(arguments.args),
        tcp_link=arguments.tcp_link,
        group=arguments.group,
    )


def _argument(text: str) -> tuple[str, str]:
    return pair(text, "NAME=VALUE", "ur_type=ur5e")
