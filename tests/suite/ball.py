"""A scenario that takes no time: the place of a ball decides whether it passes."""

SCENARIO = """\
scenario: A ball with a limit
robot: open_manipulator_x
params: {x: 0.0}
objects:
  - {name: ball, sphere: {radius: 2 cm}, pose: {xyz: ["${x}", 0.2, 0.5]}, static: true}
steps:
  - wait: 2 ms
expect:
  - formula: "always (x(ball) < 0.3)"
randomize:
  x: {uniform: [-20 cm, FARTHEST]}
samples: SAMPLES
"""
RATE = "expect_rate: {at_least: 50 %, stop_early: false}\n"


def ball(samples, rest=RATE, farthest="40 cm"):
    """Samples of a ball up to `farthest`, with further lines of the file."""
    return SCENARIO.replace("SAMPLES", str(samples)).replace("FARTHEST", farthest) + rest
