"""Scenes about what holds an object: containers without a floor, walls, welds and slopes."""

from __future__ import annotations

import numpy as np

from tests.adversarial.contact_scenes import GRASP, UP
from tests.adversarial.fixture_scenes import BIN
from tests.adversarial.scenes import RED_BOX, Scene, near, place_of, rose, speed_at_end, touched

BALL = "  - {name: ball, sphere: {radius: 0.015}, mass: 20 g, pose: {xyz: [%s]}}\n"
WAIT = "steps: [{wait: 0.2 s}]\n"


def made_of(name, place, boxes):
    """A static object of boxes, each full size and centre."""
    shapes = "".join(f"      - {{box: {{size: {a}}}, pose: {{xyz: {b}}}}}\n" for a, b in boxes)
    head = f"  - name: {name}\n    static: true\n    pose: {{xyz: {place}}}\n    shapes:\n"
    return head + shapes


TABLE = made_of("table", [0.4, 0.4, 0], [
    ([0.4, 0.4, 0.02], [0, 0, 0.3]),
    *(([0.03, 0.03, 0.29], [x, y, 0.145]) for x in (-0.18, 0.18) for y in (-0.18, 0.18)),
])  # fmt: skip
PAN = made_of("pan", [0.4, 0.3, 0], [
    ([0.16, 0.16, 0.005], [0, 0, 0.0025]),
    *(([0.005, 0.16, 0.05], [x, 0, 0.03]) for x in (-0.08, 0.08)),
    *(([0.16, 0.005, 0.05], [0, y, 0.03]) for y in (-0.08, 0.08)),
    ([0.15, 0.02, 0.01], [0.155, 0, 0.045]),
])  # fmt: skip
GATE = made_of("gate", [0.3, 0.3, 0], [
    ([0.02, 0.02, 0.1], [0, -0.06, 0.05]),
    ([0.02, 0.02, 0.1], [0, 0.06, 0.05]),
    ([0.02, 0.14, 0.02], [0, 0, 0.11]),
])  # fmt: skip
RING = made_of("ring", [0.3, 0.3, 0], [
    *(([0.01, 0.1, 0.04], [x, 0, 0.02]) for x in (-0.05, 0.05)),
    *(([0.1, 0.01, 0.04], [0, y, 0.02]) for y in (-0.05, 0.05)),
])  # fmt: skip
WALL = "  - {name: wall, in: simulation, static: true, box: {size: [0.1, 0.02, 0.5]}, "
WALL += "pose: {xyz: [0.29, 0.092, 0.25]}}\n"
STAND = "  - {name: stand, in: simulation, static: true, box: {size: [0.03, 0.03, 0.2]}, "
STAND += "pose: {xyz: [0.29, 0.0668, 0.1]}}\n"
LEANING = 0.5
SLOPE = (
    "  - {name: slope, static: true, friction: 1.2, box: {size: [0.5, 0.3, 0.01]}, "
    f"pose: {{xyz: [0.5, 0.3, 0.3], rpy: [0, {LEANING}, 0]}}}}\n"
    "  - {name: cube, box: {size: [0.04, 0.04, 0.04]}, mass: 50 g, friction: 1.2, pose: {xyz: "
    f"[{0.5 + 0.0252 * np.sin(LEANING):.5f}, 0.3, {0.3 + 0.0252 * np.cos(LEANING):.5f}], "
    f"rpy: [0, {LEANING}, 0]}}}}\n"
)


def within_outline(run, name, container, low, high):
    """Whether an object's origin is in the smallest box around a container."""
    place = place_of(run, name)[-1] - place_of(run, container)[-1]
    return bool((place > low).all() and (place < high).all())


HOOP = """
  - name: hoop
    mass: 100 g
    pose: {xyz: [-0.3, -0.3, %s]}
    shapes:
      - {box: {size: [0.3, 0.01, 0.02]}, pose: {xyz: [0, 0.145, 0]}}
      - {box: {size: [0.3, 0.01, 0.02]}, pose: {xyz: [0, -0.145, 0]}}
      - {box: {size: [0.01, 0.3, 0.02]}, pose: {xyz: [0.145, 0, 0]}}
      - {box: {size: [0.01, 0.3, 0.02]}, pose: {xyz: [-0.145, 0, 0]}}
"""
COVER = made_of("cover", [0.4, 0.4, 0.0605], [
    *(([0.01, 0.1, 0.12], [x, 0, 0]) for x in (-0.05, 0.05)),
    *(([0.1, 0.01, 0.12], [0, y, 0]) for y in (-0.05, 0.05)),
    ([0.1, 0.1, 0.01], [0, 0, 0.055]),
])  # fmt: skip
BLOCK = "  - {name: block, box: {size: [0.06, 0.06, 0.1]}, mass: 100 g, pose: {xyz: [0.4, 0.4, 0.0501]}}\n"  # noqa: E501
FAR = "  - {name: part, mass: 100 g, center_of_mass: [%s], pose: {xyz: [%s]}, shapes: [{box: {size: [0.04, 0.04, 0.04]}, pose: {xyz: [%s]}}]}\n"  # noqa: E501


def first_shape_within(run, name, container, reach):
    """The first shape's middle is less than this from the container's origin, along x and y."""
    record = next(each for each in run.objects if each.name == name)
    middle = place_of(run, name)[-1] + record.shapes[0].pose.translation
    return bool((np.abs(middle - place_of(run, container)[-1])[:2] < reach).all())


CONTAINER_SCENES = (
    Scene(
        "hoop on the floor around a bin",
        "a hoop of 30 cm lies around a bin of 20 cm, and touches none of it",
        "objects:" + BIN + HOOP % "0.0101" + WAIT,
        "its origin is in the smallest box that holds all of the bin",
        lambda run: within_outline(run, "hoop", "bin", [-0.1, -0.1, 0], [0.1, 0.1, 0.1]),
        ("in: {object: hoop, container: bin}",),
        ("on: {object: hoop, support: ground_plane}",),
        truth=lambda run: not first_shape_within(run, "hoop", "bin", 0.1),
    ),
    Scene(
        "cover over a block",
        "a cover stands over a block that it does not touch",
        "objects:\n" + BLOCK + COVER + WAIT,
        "the origin of the cover is in the smallest box that holds the block",
        lambda run: near(run, "cover", "block", (0.03, 0.03, 0.05)),
        ("in: {object: cover, container: block}",),
        ("always: {in: {object: block, container: cover}}",),
        truth=lambda run: not first_shape_within(run, "cover", "block", 0.03),
    ),
    Scene(
        "part whose origin is in a bin and nothing else of it",
        "the frame of a part is 30 cm away from its shape, as those of some CAD files are",
        "objects:" + BIN + FAR % ("0.3, 0, -0.02", "-0.3, -0.3, 0.0401", "0.3, 0, -0.02") + WAIT,
        "its origin is in the bin",
        lambda run: within_outline(run, "part", "bin", [-0.1, -0.1, 0], [0.1, 0.1, 0.1]),
        ("in: {object: part, container: bin}",),
        ("on: {object: part, support: ground_plane}",),
        truth=lambda run: not first_shape_within(run, "part", "bin", 0.1),
    ),
    Scene(
        "part whose origin is above the bin that it lies in",
        "the frame of a part is 30 cm above its shape",
        "objects:" + BIN + FAR % ("0, 0, -0.3", "-0.3, -0.3, 0.3301", "0, 0, -0.3") + WAIT,
        "its origin is outside of the bin: too strict",
        lambda run: bool(place_of(run, "part")[-1, 2] > 0.2),
        (),
        ("always: {in: {object: part, container: bin}}", "on: {object: part, support: bin}"),
        truth=lambda run: first_shape_within(run, "part", "bin", 0.08),
    ),
    Scene(
        "bin that a step puts around a box",
        "`move_object` moves a bin, 30 cm, until it surrounds a box; nothing touched the box",
        "objects:" + BIN.replace("-0.3, -0.3, 0]", "0, -0.3, 0]")
        + "  - {name: cube, box: {size: [0.04, 0.04, 0.04]}, mass: 50 g, pose: {xyz: [-0.3, -0.3, 0.0301]}}\n"  # noqa: E501
        "  - {name: pad, static: true, box: {size: [0.05, 0.05, 0.01]}, pose: {xyz: [-0.3, -0.3, 0.005]}}\n"  # noqa: E501
        "steps:\n  - wait: 0.1 s\n"
        "  - move_object: {object: bin, pose: {xyz: [-0.3, -0.3, 0]}}\n  - wait: 0.2 s\n",
        "it was outside before, and is in the middle of the bin now",
        lambda run: near(run, "cube", "bin", (0.05, 0.05, 0.05)),
        (),
        ("static: {object: cube, max_velocity: 1 m/s, max_angular_velocity: 10}",),
        warned=("in: {object: cube, container: bin}",),
    ),
    Scene(
        "ball under a table",
        "a ball lies on the floor, between the legs of a table",
        "objects:\n" + TABLE + BALL % "0.4, 0.4, 0.0151" + WAIT,
        "its origin is in the smallest box that holds all of the table",
        lambda run: within_outline(run, "ball", "table", [-0.2, -0.2, 0], [0.2, 0.2, 0.31]),
        ("in: {object: ball, container: table}",),
        ("on: {object: ball, support: ground_plane}",),
        truth=lambda run: bool(place_of(run, "ball")[-1, 2] < 0.29 - 0.015),
    ),
    Scene(
        "ball next to the handle of a pan",
        "a ball lies on the floor, aside of the pan and under the height of its handle",
        "objects:\n" + PAN + BALL % "0.55, 0.36, 0.0151" + WAIT,
        "its origin is in the smallest box that holds all of the pan",
        lambda run: within_outline(run, "ball", "pan", [-0.08, -0.08, 0], [0.23, 0.08, 0.055]),
        ("in: {object: ball, container: pan}", "on: {object: ball, support: pan}"),
        ("on: {object: ball, support: ground_plane}",),
        truth=lambda run: bool(place_of(run, "ball")[-1, 0] - 0.015 > 0.4 + 0.0825),
    ),
    Scene(
        "ball in a gateway",
        "a ball lies on the floor between two posts, under the beam that they carry",
        "objects:\n" + GATE + BALL % "0.3, 0.3, 0.0151" + WAIT,
        "its origin is in the smallest box that holds all of the gate",
        lambda run: within_outline(run, "ball", "gate", [-0.01, -0.07, 0], [0.01, 0.07, 0.12]),
        ("in: {object: ball, container: gate}",),
        ("on: {object: ball, support: ground_plane}",),
    ),
    Scene(
        "ball in a ring without a floor",
        "a ball lies on the floor, and a frame of four boards stands around it",
        "objects:\n" + RING + BALL % "0.3, 0.3, 0.0151" + WAIT,
        "nothing of the ring is under the ball: too strict",
        lambda run: bool(np.abs(place_of(run, "ball")[-1, :2] - 0.3).max() < 0.045),
        (),
        ("always: {in: {object: ball, container: ring}}",),
    ),
    Scene(
        "cube rubbed up a wall by one finger",
        "the gripper opens, a finger presses a cube against a wall, and the arm rises",
        "objects:\n" + WALL + STAND
        + "  - {name: cube, in: simulation, box: {size: [0.02, 0.03, 0.03]}, mass: 20 g, "
        "friction: 1, pose: {xyz: [0.29, 0.0668, 0.2151]}}\n"
        "steps:\n  - gripper: open\n" + UP + "  - wait: 0.2 s\n",
        "it rose by 1 cm and touches the gripper",
        lambda run: rose(run, "cube", 0.01) and touched(run, "cube"),
        ("lifted: {object: cube, above: 1 cm}", "grasped: cube", "never: collision"),
        ("displaced: {object: cube, at_least: 1 cm}",),
    ),
    Scene(
        "welded box that hangs from the open hand",
        "`mode: weld` fixes the box to the palm, it is lifted, and the fingers open",
        "objects:\n" + RED_BOX + "steps:"
        + GRASP.replace("grasp: red_box", "grasp: {object: red_box, mode: weld}")
        + UP + "  - gripper: open\n  - wait: 0.1 s\n",
        "no link of the robot touches it",
        lambda run: not touched(run, "red_box"),
        ("released: red_box", "placed: red_box"),
        ("lifted: {object: red_box, above: 4 cm}",),
        truth=lambda run: bool(np.ptp(place_of(run, "red_box")[-90:, 2]) < 0.001),
    ),
    Scene(
        "box at rest on a slope of 29 degrees",
        "friction of 1.2 holds a box on a slope whose tangent is 0.55",
        "objects:\n" + SLOPE + "steps: [{wait: 0.3 s}]\n",
        "the support's normal points up to within 10 degrees: too strict",
        lambda run: speed_at_end(run, "cube") < 0.005 and near(run, "cube", "slope", (0.1,) * 3),
        (),
        ("on: {object: cube, support: slope}", "static: cube"),
    ),
)  # fmt: skip
