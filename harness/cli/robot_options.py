"""Options that say which robot a command is about."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from harness.robot_tools.robot_source import RobotSource

ROBOT = "a bundled name; a URDF, xacro or MJCF file, also as package://name/path; a robot's folder"


def add_robot_options(command: argparse.ArgumentParser, *, has_srdf: bool = True) -> None:
    """Add what goes with a robot's file; `has_srdf` says whether `--srdf` is among it."""
    add = command.add_argument
    if has_srdf:
        add(
            "--srdf",
            metavar="FILE",
            default="",
            help="read groups, states and allowed pairs from this SRDF",
        )
    add("--package-path", metavar="DIR", action="append", default=[],
        help="look package:// up in this folder, and allow meshes to be read there")  # fmt: skip
    add("--gripper", metavar="NAME", default="",
        help="mount this bundled gripper, or name the SRDF group of the arm's own one")  # fmt: skip
    add("--args", metavar="NAME=VALUE", action="append", type=_argument, default=[],
        help="set an argument of a xacro file")  # fmt: skip
    add("--group", metavar="NAME", default="", help="the SRDF group of the arm")
    add("--tcp-link", metavar="LINK", default="", help="the link at the tool centre point")


def source_of(arguments: argparse.Namespace) -> RobotSource:
    """Which robot the options say."""
    from harness.robot_tools.robot_source import RobotSource

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
    name, equals, value = text.partition("=")
    if not equals or not name.strip():
        raise argparse.ArgumentTypeError(f"'{text}' is not NAME=VALUE, as in ur_type=ur5e")
    return name.strip(), value
