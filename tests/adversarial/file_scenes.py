"""Scenario files that say something else than they seem to: refused before anything moves."""

from __future__ import annotations

from dataclasses import dataclass

FILE = """scenario: a file
robot: {model: open_manipulator_x, base: {xyz: [0, 0, 0.01]}}
world: empty
params: {time: 0.1 s}
objects:
  - {name: NAME, box: {size: [0.04, 0.04, 0.04]}, pose: {xyz: [0.3, -0.2, 0.02]}}
steps:
  - wait: "${time}"
expect:
  - EXPECT
"""


@dataclass(frozen=True)
class FileScene:
    """A file.

    Attributes:
        title: What it is.
        says: Part of our message; empty where the file is as it should be.
        name: Of its object.
        expect: Its expectation.
        varied: Its variation.
    """

    title: str
    says: str = ""
    name: str = "cube"
    expect: str = "static: {}"
    varied: str = ""

    def text(self):
        """The file."""
        text = FILE.replace("NAME", self.name).replace("EXPECT", self.expect)
        return text + (f"{self.varied}\n" if self.varied else "")


FILES = (
    FileScene("grid over a parameter that nothing reads", "no parameter is called `tiem`",
              varied="parametrize: {params.tiem: [0.1 s, 0.2 s]}"),
    FileScene("random parameter that nothing reads", "no parameter is called `tiem`",
              varied="randomize: {params.tiem: {uniform: [0.1 s, 0.2 s]}}"),
    FileScene("grid without values", "takes a list of values in turn",
              varied="parametrize: {seed: []}"),
    FileScene("grid over a parameter that a step reads",
              varied="parametrize: {params.time: [0.1 s, 0.2 s]}"),
    FileScene("object called `any`", "is a word of expectations", name="any",
              expect="never: {in_contact: {between: [robot, any]}}"),
    FileScene("object called like a link", "is a robot link's name", name="link5",
              expect="never: {in_contact: {between: [robot, link5]}}"),
    FileScene("tolerance that no position is beyond", "is decided without a run",
              expect="joints: {positions: {joint1: 0}, tolerance: 100}"),
    FileScene("degrees for a joint's position", "`position(joint1) < 90` always holds",
              expect="formula: always position(joint1) < 90"),
    FileScene("degrees a second for a joint", "`90 < velocity(joint1)` never holds",
              expect="formula: eventually 90 < velocity(joint1)"),
    FileScene("position a little beyond the joint's limit",
              expect="formula: always abs(position(joint1)) < 4 and position(joint1) < 3.2"),
    FileScene("number that is beyond any other", "is too large",
              expect="formula: always z(cube) < 1e999"),
    FileScene("length for a joint that turns", "is a length; an angle is expected",
              expect="joints: {positions: {joint1: 5 cm}}"),
    FileScene("degrees without a unit", "`tilt(cube) < 90` always holds",
              expect="formula: always tilt(cube) < 90"),
    FileScene("tolerance of 5 rad", "must be less than 3.14159",
              expect="upright: {object: cube, tolerance: 5}"),
    FileScene("lean that no object exceeds", "must be less than 3.14159",
              expect="upright: {object: cube, tolerance: 180 deg}"),
    FileScene("effort of 80 times the limit", "must be at most 1", expect="effort: 80"),
    FileScene("share that is none of it", "must be more than 0", expect="fraction: 0"),
    FileScene("tracking error in degrees", "the tracking error is between 0 and 6.28",
              expect="tracking_error: 20"),
    FileScene("formula of two numbers", "reads no signal", expect="formula: always 0.4 > 0.3"),
    FileScene("height that is above 1 m, or is not", "(z(cube) > 1 m or z(cube) <= 1 m)` always",
              expect="formula: always (z(cube) > 1 m or z(cube) <= 1 m)"),
    FileScene("cube 5 m inside the hand", "always holds",
              expect="formula: always distance(robot, cube) >= -5"),
    FileScene("joint far beyond its stop", "is decided without a run",
              expect="never: {joints: {positions: {joint1: 100}}}"),
    FileScene("gap that no gripper has", "is decided without a run",
              expect="never: {gripper: {width: 10}}"),
    FileScene("height that is above 1 m, or below it",
              expect="formula: always (z(cube) > 1 m or z(cube) < 1 m)"),
    FileScene("force that no contact has", "never holds",
              expect="formula: eventually force(robot, cube) < 0 N"),
    FileScene("contact of a link without a shape", "has no collision shape",
              expect="never: {in_contact: {between: [end_effector_link, cube]}}"),
    FileScene("contact of links that the SRDF excludes", "can never touch",
              expect="never: {in_contact: {between: [gripper, gripper]}}"),
    FileScene("force between links that a joint connects", "can never touch",
              expect='formula: "always force(link4, link5) < 1 N"'),
    FileScene("contact of two things that cannot move", "neither of them can move",
              expect="never: {in_contact: {between: [link1, ground_plane]}}"),
    FileScene("contact and depth of links that may touch",
              expect="never: {collision: {between: [gripper, gripper], count_allowed: true}}"),
    FileScene("TCP in the frame of its own link", "never moves in the frame",
              expect="tcp_pose: {pose: {xyz: [0, 0, 0], frame: end_effector_link}}"),
    FileScene("TCP in the frame of a link that is fixed to it", "never moves in the frame",
              expect="tcp_pose: {pose: {xyz: [0, 0, 0], frame: link5}}"),
    FileScene("object placed in its own frame", "never moves in the frame",
              expect="placed: {object: cube, pose: {xyz: [0, 0, 0], frame: cube}}"),
    FileScene("object in itself", "is not in itself",
              expect="in: {object: cube, container: cube}"),
    FileScene("TCP in the frame of a link that it moves against",
              expect="tcp_pose: {pose: {xyz: [0, 0, 0], frame: link4}}"),
    FileScene("angles and lengths where they belong",
              expect="joints: {positions: {joint1: 5 deg, gripper_left_joint: 5 mm}}"),
)  # fmt: skip
