"""The process that a function under test lives in: it answers calls until the caller hangs up."""

from __future__ import annotations

import socket
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

from harness.core.errors import HarnessError
from harness.iktest.calls import call
from harness.iktest.contract import UnusableSolver, parameter_words
from harness.iktest.find_function import OWN, find_function, is_solver
from harness.robot_tools.robot_source import RobotSource


def serve(name: str, robot: RobotSource, tip: str, dof: int, address: str, _notify: object) -> bool:
    """Load a function, then call it with whatever arguments come.

    Sends ("unusable", why) or ("ready", parameter words), then an `Outcome` for each mapping of
    arguments that it receives.

    Args:
        name: The name as `find_function` takes it, that of a registered solver, or `own`.
        robot: The arm, for solvers.
        tip: The link that is placed, for solvers; empty for the TCP.
        dof: The number of the arm's joints.
        address: The address of the caller's Unix socket.
    """
    link = socket.socket(socket.AF_UNIX)
    link.connect(address)
    with Connection(link.detach()) as connection:
        try:
            function = load_solver(name, robot, tip)
            words = parameter_words(function)
        except (UnusableSolver, HarnessError) as error:
            connection.send(("unusable", str(error)))
            return True
        connection.send(("ready", words))
        while True:
            try:
                arguments = connection.recv()
            except EOFError:
                return True
            connection.send(call(function, arguments, dof))


def load_solver(name: str, robot: RobotSource, tip: str) -> Callable[..., Any]:
    """The function of a name, or a function that calls a registered solver."""
    if ":" in name or not is_solver(name):
        return find_function(name)
    from harness.robot_tools.builtin_ik import own_solver, plugin_solver

    return own_solver(robot, tip) if name == OWN else plugin_solver(name, robot, tip)
