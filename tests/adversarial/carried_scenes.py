"""Scenes about stacks: what carries, rides on, or is carried by what the hand holds."""

from __future__ import annotations

import numpy as np

from harness.recording.run import Run
from tests.adversarial.scenes import Scene, place_of, rose, speed_at_end, touched
from tests.second_opinion.runs import SRDF, URDF

GANTRY = "{urdf: gantry.urdf, srdf: gantry.srdf, gripper: hand, start_state: {named_target: ready}}"
FILES = {"gantry.urdf": URDF, "gantry.srdf": SRDF}
TRAY = (
    "objects:\n  - {name: tray, in: simulation, pose: {xyz: [0, 0, 0.0051]}, mass: 300 g, shapes: ["
    "{box: {size: [0.4, 0.1, 0.01]}}, "
    "{box: {size: [0.02, 0.03, 0.08]}, pose: {xyz: [0, 0, 0.045]}}]}\n"
)
CUBE = (
    "  - {name: %s, in: simulation, box: {size: [0.04, 0.04, 0.04]}, mass: 50 g, "
    "pose: {xyz: [%s]}}\n"
)
SLAB = "  - {name: %s, in: simulation, static: true, box: {size: [%s]}, pose: {xyz: [%s]}}\n"
GRIP = (
    "steps:\n  - gripper: open\n  - ptp: {joints: {slide: 0, lift: 0.12}}\n"
    "  - gripper: {position: 0.0, max_effort: 20}\n"
)
UP = "  - ptp: {joints: {slide: 0, lift: 0.3}}\n"
WAIT = "  - wait: 0.3 s\n"
CUP = CUBE % ("cup", "0.12, 0, 0.0302")
PART = CUBE % ("part", "0.12, 0, 0.0703")
BOARD = "  - {name: %s, in: simulation, box: {size: [0.01, 0.06, 0.08]}, mass: 50 g, friction: 1, "
BOARD += "pose: {xyz: [%s, 0, 0.0505], rpy: [0, %s, 0]}}\n"
LEANING = BOARD % ("first", 0.10, 0.25) + BOARD % ("second", 0.131, -0.25)
SAGS = (
    "  - {name: part, in: simulation, pose: {xyz: [%s]}, mass: 500 g, center_of_mass: [%s], "
    "shapes: [{box: {size: [0.12, 0.02, 0.04]}, pose: {xyz: [%s]}}], "
    "friction: {sliding: 1, torsional: 0.001}}\n"
)
HOLD = (
    "steps:\n  - gripper: open\n  - ptp: {joints: {slide: 0, lift: 0.08}}\n"
    "  - gripper: {position: 0.0, max_effort: 17}\n  - ptp: {joints: {slide: 0, lift: 0.2}}\n"
    "  - wait: 1.2 s\n"
)
FINGERS = ("palm", "finger_left", "finger_right")
ROD = "objects:\n  - {name: rod, in: simulation, box: {size: [0.4, 0.03, 0.04]}, mass: 100 g, pose: {xyz: [0, 0, 0.0201]}}\n"  # noqa: E501
LOW = GRIP.replace("0.12", "0.08")
SLOWLY = "  - ptp: {joints: {slide: %s, lift: %s}}\n    planning: {max_velocity_scaling_factor: 0.1, max_acceleration_scaling_factor: 0.1}\n"  # noqa: E501
WALL = SLAB % ("wall", "0.02, 0.3, 0.6", "%s, 0, 0.3")


def put(where: str) -> str:
    """The gantry takes a cube and puts it somewhere, by the height of the palm."""
    return (
        "steps:\n  - gripper: open\n  - ptp: {joints: {slide: -0.2, lift: 0.08}}\n"
        "  - gripper: {position: 0.0, max_effort: 20}\n"
        "  - ptp: {joints: {slide: -0.2, lift: 0.3}}\n"
        "  - ptp: {joints: {slide: 0.1, lift: 0.3}}\n"
        f"  - ptp: {{joints: {{slide: 0.1, lift: {where}}}}}\n  - gripper: open\n"
        "  - ptp: {joints: {slide: 0.1, lift: 0.3}}\n  - wait: 0.3 s\n"
    )


def at_rest_above(run: Run, name: str, height: float) -> bool:
    """An object stands still at the end, this high above where it was [m]."""
    z = place_of(run, name)[:, 2]
    return bool(z[-1] - z[0] > height and speed_at_end(run, name) < 0.005)


def met(run: Run, first: str, second: str) -> bool:
    """Two bodies touch at some time."""
    return any(set(pair) == {first, second} for pair in run.signals.contact_forces)


def presses(run: Run, first: str, second: str) -> bool:
    """Two bodies touch when the run ends."""
    forces = run.signals.contact_forces
    return any(forces[pair][-1] > 0 for pair in forces if set(pair) == {first, second})


def moved_in_palm(run: Run, name: str, point: tuple[float, float, float]) -> float:
    """How far a point of an object moved along x and z against the TCP since it left its place [m].

    The palm of the gantry never turns, and the object turns about y alone.
    """
    poses = run.signals.object_poses[name]
    pitch = 2 * np.arctan2(poses[:, 5], poses[:, 3])
    x = poses[:, 0] + np.cos(pitch) * point[0] + np.sin(pitch) * point[2]
    z = poses[:, 2] - np.sin(pitch) * point[0] + np.cos(pitch) * point[2]
    apart = np.column_stack([x, z]) - run.signals.tcp_pose[:, [0, 2]]
    began = next(
        step for step in run.steps if step.verb == "gripper" and step.start_time > 0
    ).end_index
    return float(np.linalg.norm(apart[began:] - apart[began], axis=1).max())


def carried_within(run: Run, name: str, support: str, samples: int) -> bool:
    """Two bodies touch at one of the last samples."""
    forces = run.signals.contact_forces
    return any(
        (forces[pair][-samples:] > 0).any() for pair in forces if set(pair) == {name, support}
    )


def gantry(title, happens, text, naive, says, expect, stays=(), **more):
    """A scene of the gantry."""
    return Scene(
        title, happens, text, naive, says, expect, stays, robot=GANTRY, files=FILES, **more
    )


CARRIED_SCENES = (
    gantry(
        "part on a tray in the hand",
        "the hand grips a tray and raises it by 18 cm, with a part on it",
        TRAY + CUP + GRIP + UP + WAIT,
        "nothing of the robot touches the part, which stands still on the tray",
        lambda run: not touched(run, "cup") and speed_at_end(run, "cup") < 0.005,
        ("placed: {object: cup, on: tray}", "placed: cup"),
        ("on: {object: cup, support: tray}", "lifted: {object: tray, above: 10 cm}"),
        truth=lambda run: at_rest_above(run, "cup", 0.15),
    ),
    gantry(
        "part on a cup on a tray in the hand",
        "the same with a cup between them: nothing that the hand holds touches the part",
        TRAY + CUP + PART + GRIP + UP + WAIT,
        "the part stands still on a cup that the hand neither touches nor holds",
        lambda run: not touched(run, "cup") and speed_at_end(run, "part") < 0.005,
        ("placed: {object: part, on: cup}", "placed: part", "placed: cup",
         "never: {lifted: {object: tray, above: 10 cm}}"),
        ("on: {object: part, support: cup}", "lifted: {object: tray, above: 10 cm}"),
        truth=lambda run: at_rest_above(run, "part", 0.15),
    ),
    Scene(
        "cube on a plank that lies across both fingers",
        "a plank lies on the open fingers like on a shelf, and a cube on the plank",
        "objects:\n  - {name: plank, box: {size: [0.03, 0.11, 0.004]}, mass: 60 g, friction: 2, "
        "in: simulation, pose: {xyz: [0.286, 0, 0.2168]}}\n"
        "  - {name: cube, box: {size: [0.02, 0.02, 0.02]}, mass: 20 g, friction: 1, "
        "in: simulation, pose: {xyz: [0.286, 0, 0.2288]}}\n"
        "steps:\n  - wait: 0.2 s\n"
        "  - move_relative: {direction: {xyz: [0, 0, 1]}, distance: 6 cm}\n" + WAIT,
        "the robot holds neither of them, and the cube stands still on the plank",
        lambda run: not touched(run, "cube") and speed_at_end(run, "cube") < 0.005,
        ("placed: {object: cube, on: plank}", "placed: cube", "placed: plank"),
        ("on: {object: cube, support: plank}",),
        truth=lambda run: at_rest_above(run, "cube", 0.05),
    ),
    gantry(
        "cube put down with a tenth of it on the goal",
        "of its 4 cm 3 mm reach over the goal, and the rest over the table next to it",
        "objects:\n" + CUBE % ("cube", "-0.2, 0, 0.0201")
        + SLAB % ("table", "0.217, 0.2, 0.02", "0.0085, 0, 0.01")
        + SLAB % ("goal", "0.1, 0.2, 0.02", "0.167, 0, 0.01")
        + put("0.102"),
        "it stands still, the goal presses it from below, and the robot does not touch it",
        lambda run: not touched(run, "cube") and presses(run, "goal", "cube"),
        ("placed: {object: cube, on: goal}", "on: {object: cube, support: goal}"),
        ("placed: {object: cube, on: table}", "placed: cube"),
        truth=lambda run: bool(place_of(run, "cube")[-1, 0] + 0.015 < 0.117),
    ),
    gantry(
        "cube put on a block that stands on the floor",
        "the block can move, and nothing of the robot carries it",
        "objects:\n" + CUBE % ("cube", "-0.2, 0, 0.0201") + CUBE % ("block", "0.1, 0, 0.0201")
        + put("0.122"),
        "what it stands on is not fixed: too strict",
        lambda run: not touched(run, "block", at_end=False),
        (),
        ("placed: {object: cube, on: block}", "placed: cube",
         "placed: {object: cube, pose: {xyz: [0.1, 0, 0.06]}}"),
    ),
    gantry(
        "table that a step takes away",
        "a step moves a table 60 cm aside, and 4 ms later the cube on it has not begun to fall",
        "objects:\n" + CUBE % ("cube", "0, 0, 0.1201")
        + SLAB % ("table", "0.2, 0.2, 0.1", "0, 0, 0.05")
        + WAIT.replace("  -", "steps:\n  -")
        + "  - move_object: {object: table, pose: {xyz: [0, 0.6, 0.05]}}\n  - wait: 4 ms\n",
        "a contact within the last 10 ms carried it, as long as a contact may be interrupted",
        lambda run: carried_within(run, "cube", "table", 10),
        ("on: {object: cube, support: table}", "placed: {object: cube, on: table}"),
        ("static: {object: cube, max_velocity: 0.1}",),
        truth=lambda run: not carried_within(run, "cube", "table", 3),
    ),
    gantry(
        "plank on two posts",
        "a plank lies on two posts, each of which carries half of it",
        "objects:\n  - {name: plank, in: simulation, box: {size: [0.3, 0.05, 0.02]}, mass: 200 g, "
        "pose: {xyz: [0.0002, 0, 0.11]}}\n"
        + SLAB % ("post_a", "0.02, 0.05, 0.1", "-0.1, 0, 0.05")
        + SLAB % ("post_b", "0.02, 0.05, 0.1", "0.1, 0, 0.05")
        + WAIT.replace("  -", "steps:\n  -"),
        "at some time one of them carries less than half of it: too strict",
        lambda run: bool(
            (run.signals.contact_forces["plank", "post_a"][-100:] < 0.98).any()
        ),
        (),
        ("on: {object: plank, support: post_a, for: 0.1 s}",
         "on: {object: plank, support: post_b, for: 0.1 s}"),
    ),
    gantry(
        "tray lifted with two loads that lean on each other",
        "two boards stand against each other on a tray that the hand raises",
        TRAY + LEANING + GRIP + UP + WAIT,
        "each of them touches something that is neither the tray nor the hand: too strict",
        lambda run: presses(run, "first", "second") and rose(run, "tray", 0.15),
        ("never: {lifted: {object: tray, above: 10 cm}}", "placed: first"),
        ("lifted: {object: tray, above: 10 cm}",),
        truth=lambda run: at_rest_above(run, "first", 0.15),
    ),
    gantry(
        "tray raised with a plank that lies on a shelf, too",
        "one end of the plank lies on the tray, the other on a fixed shelf, which bears part of it",
        TRAY + SLAB % ("shelf", "0.1, 0.2, 0.02", "0.4, 0, 0.02")
        + "  - {name: plank, in: simulation, box: {size: [0.3, 0.04, 0.01]}, mass: 100 g, "
        "pose: {xyz: [0.24, 0, 0.0285], rpy: [0, -0.087, 0]}}\n"
        + GRIP + "  - ptp: {joints: {slide: 0, lift: 0.16}}\n" + WAIT,
        "the tray itself touches the hand and its load alone, and it rose by 3 cm",
        lambda run: rose(run, "tray", 0.03) and not presses(run, "tray", "ground_plane"),
        ("lifted: {object: tray, above: 2 cm}",),
        ("grasped: tray", "never: {in_contact: {between: [tray, shelf]}}"),
        truth=lambda run: presses(run, "plank", "shelf"),
    ),
    gantry(
        "load on a held tray is pushed against a beam",
        "the hand moves a tray until its load meets a beam, which pushes it 3 mm along the tray",
        TRAY + CUP + SLAB % ("beam", "0.02, 0.3, 0.03", "0.26, 0, 0.22")
        + GRIP + UP + SLOWLY % (0.113, 0.3) + WAIT,
        "neither the robot nor what it grips touches the beam",
        lambda run: not touched(run, "beam", at_end=False) and not met(run, "tray", "beam"),
        ("never: collision", "never: {collision: {between: [cup, beam]}}",
         "clearance: {between: [cup, beam], at_least: 5 mm}"),
        ("never: {collision: {between: [tray, beam]}}", "on: {object: cup, support: tray}"),
        truth=lambda run: met(run, "cup", "beam"),
        warned=("clearance: {between: [robot, beam], at_least: 5 mm}",),
    ),
    gantry(
        "stack on a held tray is raised against a beam",
        "the upper of two cubes on a tray in the hand meets a beam above it",
        TRAY + CUP + PART + SLAB % ("beam", "0.1, 0.3, 0.02", "0.16, 0, 0.26")
        + GRIP + SLOWLY % (0, 0.281) + WAIT,
        "neither the robot nor what it grips nor what lies on that touches the beam",
        lambda run: not any(met(run, name, "beam") for name in ("tray", "cup", *FINGERS)),
        ("never: collision", "never: {collision: {between: [part, beam]}}"),
        ("never: {collision: {between: [cup, beam]}}",),
        truth=lambda run: met(run, "part", "beam"),
    ),
    gantry(
        "gripped rod comes within 5 mm of a wall",
        "the fingers close on a rod, with no step that attaches it, and carry it to a wall",
        ROD + WALL % "0.36" + LOW + UP + "  - ptp: {joints: {slide: 0.145, lift: 0.3}}\n" + WAIT,
        "the links of the robot stay 10 cm away from the wall",
        lambda run: bool((run.signals.clearances["robot", "wall"] > 0.1).all()),
        ("clearance: {between: [rod, wall], at_least: 2 cm}",
         "formula: always distance(rod, wall) > 2 cm"),
        ("grasped: rod", "clearance: {between: [rod, wall], at_least: 4 mm}"),
        truth=lambda run: bool(np.abs(place_of(run, "rod")[:, 0].max() + 0.2 - 0.345) < 1e-3),
        warned=("clearance: {between: [robot, wall], at_least: 5 cm}",),
    ),
    gantry(
        "tray with a stack set down again",
        "the hand raises a tray with two cubes, and puts it where it was",
        TRAY + CUP + PART + WALL % "0.36" + GRIP + UP + SLOWLY % (0, 0.1202)
        + "  - gripper: open\n" + WAIT,
        "what is carried touches something else than the hand: too strict",
        lambda run: rose(run, "part", 0.1) and presses(run, "tray", "ground_plane"),
        (),
        ("never: {collision: {between: [cup, tray]}}", "never: {collision: {between: [part, cup]}}",
         "never: {collision: {between: [tray, ground_plane]}}",
         "clearance: {between: [cup, wall], at_least: 10 cm}",
         "lifted: {object: tray, above: 10 cm}"),
    ),
    gantry(
        "post fixed in the world between the fingers",
        "the hand grips a post that is part of the building",
        "objects:\n" + SLAB % ("post", "0.03, 0.03, 0.05", "0, 0, 0.025") + LOW + WAIT,
        "both fingers press it from opposite sides, and it does not slip",
        lambda run: presses(run, "finger_left", "post") and presses(run, "finger_right", "post"),
        ("grasped: post", "lifted: {object: post, above: 1 mm}"),
        ("in_contact: {between: [gripper, post]}",),
        truth=lambda run: bool(np.ptp(place_of(run, "post"), axis=0).max() == 0),
    ),
    gantry(
        "part that sags in the grip, with its frame far away",
        "a part turns by 7 degrees between the fingers; its origin is 60 cm above them",
        "objects:\n" + SAGS % ("0, 0, 0.62", "0.0297, 0, -0.6", "0, 0, -0.6") + HOLD,
        "its origin moved by more than 2 cm in the hand: too strict",
        lambda run: moved_in_palm(run, "part", (0, 0, 0)) > 0.02,
        ("grasped: part",),
        ("grasped: {object: part, max_rotation: 20 deg}", "lifted: {object: part, above: 5 cm}"),
        truth=lambda run: moved_in_palm(run, "part", (0, 0, -0.6)) < 0.005,
    ),
)  # fmt: skip
