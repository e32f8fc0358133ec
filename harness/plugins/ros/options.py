"""Options of the commands that join a ROS domain."""

from __future__ import annotations

import argparse

from harness.cli.arguments import positive_number
from harness.cli.shared_options import add_node


def add_domain(command: argparse.ArgumentParser) -> None:
    """The options of commands that join a ROS domain."""
    add = command.add_argument
    text = "join this ROS domain (default: ROS_DOMAIN_ID or 0; with --node, a free one)"
    add("--domain", metavar="N", type=int, default=None, help=text)
    add("--network", action="store_true", help="communicate with nodes on other machines too")


def add_served_robot(command: argparse.ArgumentParser) -> None:
    """The options of commands that serve a simulated robot to ROS 2 nodes."""
    add_node(command, "the scenario to start this command: 'python student.py'")
    add_domain(command)
    command.add_argument(
        "--pace",
        metavar="FACTOR",
        type=positive_number("simulated seconds in a second"),
        default=1.0,
        help="advance this many simulated seconds in one second of wall time (default: 1)",
    )
