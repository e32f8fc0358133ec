"""A collection of robots: the folders in `robots` next to this file."""

from pathlib import Path

from harness.robot.robot_collection import RobotCollection


class ExampleRobots(RobotCollection):
    """A gantry with three sliding joints."""

    name = "example_robots"
    folder = Path(__file__).with_name("robots")
