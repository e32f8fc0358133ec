"""Scenes in which steps put objects, bodies are far away, nested or stacked, or rub and rattle."""

from __future__ import annotations

import numpy as np

from harness.recording.run import Run
from tests.adversarial.scenes import TRAY, Scene, near, place_of, touched

CUBE = "  - {name: cube, box: {size: [0.04, 0.04, 0.04]}, mass: 50 g, pose: {xyz: [0.3, -0.2, 0.02]}}\n"  # noqa: E501
PUT = "steps:\n  - wait: 0.1 s\n  - move_object: {object: cube, pose: {xyz: [%s]}}\n  - wait: %s\n"
BIN = """
  - name: bin
    static: true
    pose: {xyz: [-0.3, -0.3, 0]}
    shapes:
      - {box: {size: [0.2, 0.2, 0.01]}, pose: {xyz: [0, 0, 0.005]}}
      - {box: {size: [0.2, 0.01, 0.1]}, pose: {xyz: [0, 0.1, 0.05]}}
      - {box: {size: [0.2, 0.01, 0.1]}, pose: {xyz: [0, -0.1, 0.05]}}
      - {box: {size: [0.01, 0.2, 0.1]}, pose: {xyz: [0.1, 0, 0.05]}}
      - {box: {size: [0.01, 0.2, 0.1]}, pose: {xyz: [-0.1, 0, 0.05]}}
"""
CUP_IN_BIN = """
  - name: cup
    static: true
    pose: {xyz: [-0.3, -0.3, 0.045], rpy: [1.5708, 0, 0]}
    shapes:
      - {box: {size: [0.07, 0.07, 0.004]}, pose: {xyz: [0, 0, -0.04]}}
      - {box: {size: [0.07, 0.004, 0.08]}, pose: {xyz: [0, 0.033, 0]}}
      - {box: {size: [0.07, 0.004, 0.08]}, pose: {xyz: [0, -0.033, 0]}}
"""
PILLAR = "  - {name: %s, static: true, box: {size: [0.1, 0.1, 0.1]}, pose: {xyz: [%s, 0, 0.05]}}\n"
KNOCKS = (
    "objects:\n" + CUBE
    + "steps:\n  - wait: 60 ms\n"
    + "  - inject: {push: {cube: [0, 0, 0.6]}}\n  - wait: 0.2 s\n" * 3
)  # fmt: skip


def touches(run: Run, *pair: str) -> np.ndarray:
    """Samples at which two bodies touch."""
    forces = run.signals.contact_forces
    return next(force > 1e-3 for key, force in forces.items() if set(key) == set(pair))


def longest_touch(run: Run, *pair: str) -> float:
    """The longest time for which two bodies touch at every sample [s]."""
    apart = np.flatnonzero(np.concatenate([[True], ~touches(run, *pair), [True]]))
    return float(np.diff(apart).max() - 2) * run.timestep


def apart(run: Run, name: str) -> float:
    """From the TCP to an object's origin at least [m]: the arm is shorter than 40 cm."""
    offset = place_of(run, name) - run.signals.tcp_pose[:, :3]
    return float(np.linalg.norm(offset, axis=1).min())


FIXTURE_SCENES = (
    Scene(
        "box that a step puts on the tray",
        "`move_object` puts a box on the tray, and the arm never moves",
        "objects:\n" + TRAY + CUBE + PUT % ("0.3, 0.3, 0.04", "0.2 s"),
        "it was elsewhere before, stands on the tray now, and nothing of the robot touches it",
        lambda run: near(run, "cube", "tray", (0.1, 0.1, 0.04)) and not touched(run, "cube"),
        (),
        ("static: cube",),
        warned=(
            "placed: {object: cube, on: tray}",
            "placed: {object: cube, pose: {xyz: [0.3, 0.3, 0.04]}}",
        ),
    ),
    Scene(
        "box that a step puts into the bin",
        "`move_object` puts a box into the bin, and the arm never moves",
        "objects:" + BIN + CUBE + PUT % ("-0.3, -0.3, 0.03", "0.2 s"),
        "it was outside before, and is less than 5 cm from the bin's middle now",
        lambda run: near(run, "cube", "bin", (0.05, 0.05, 0.05)),
        (),
        ("on: {object: cube, support: bin}",),
        warned=("in: {object: cube, container: bin}",),
    ),
    Scene(
        "box that a step lets fall into the bin",
        "`move_object` puts a box above the bin, and it falls 10 cm",
        "objects:" + BIN + CUBE + PUT % ("-0.3, -0.3, 0.13", "0.5 s"),
        "a step moved it, so that its place shows nothing: too strict",
        lambda run: not touched(run, "cube", at_end=False),
        (),
        ("in: {object: cube, container: bin}", "placed: {object: cube, on: bin}"),
    ),
    Scene(
        "pillar further away than distances are recorded",
        "a pillar stands 3.6 m from the arm, and distances are recorded up to 2 m",
        "objects:\n" + PILLAR % ("pillar", "4") + "steps: [{wait: 0.1 s}]\n",
        "the recorded distance is below 3 m",
        lambda run: bool((run.signals.clearances["robot", "pillar"] < 3).all()),
        (
            "formula: always distance(robot, pillar) < 3 m",
            "formula: always distance(robot, pillar) * 2 < 5 m",
        ),
        ("formula: always distance(robot, pillar) > 1 m",),
        truth=lambda run: apart(run, "pillar") > 3.4,
    ),
    Scene(
        "pillar within 2 m",
        "a pillar stands 1.6 m from the arm, and the formula names 1.9 m",
        "objects:\n" + PILLAR % ("pillar", "2") + "steps: [{wait: 0.1 s}]\n",
        "distances of more than 1 m are not recorded: too strict",
        lambda run: bool((run.signals.clearances["robot", "pillar"] < 1.9).all()),
        (),
        (
            "formula: always distance(robot, pillar) < 1.9 m",
            "formula: always distance(robot, pillar) > 1.5 m",
        ),
        truth=lambda run: 1.5 < apart(run, "pillar") < 1.95,
    ),
    Scene(
        "nearer of two pillars called the further one",
        "one pillar stands 1 m, the other 2 m away; distances are recorded up to 15 cm",
        "objects:\n"
        + PILLAR % ("first", "1.4")
        + PILLAR % ("second", "2.4")
        + "steps: [{wait: 0.1 s}]\n",
        "its recorded distance is at least that of the other",
        lambda run: bool(
            (
                run.signals.clearances["robot", "first"]
                >= run.signals.clearances["robot", "second"]
            ).all()
        ),
        (
            "formula: always distance(robot, first) >= distance(robot, second)",
            "formula: not eventually distance(robot, first) < distance(robot, second)",
        ),
        ("clearance: {between: [robot, first], at_least: 10 cm}",),
        truth=lambda run: apart(run, "first") < apart(run, "second") - 0.9,
    ),
    Scene(
        "ball in a cup that lies in a bin",
        "a cup lies on its side in a bin, and the ball in it",
        "objects:"
        + BIN
        + CUP_IN_BIN
        + "  - {name: ball, sphere: {radius: 0.01}, mass: 5 g, pose: {xyz: [-0.3, -0.3, 0.03]}}\n"
        "steps: [{wait: 0.3 s}]\n",
        "the ball is less than 4 cm from the cup's middle",
        lambda run: near(run, "ball", "cup", (0.04, 0.04, 0.04)),
        ("in: {object: ball, container: cup}", "on: {object: ball, support: bin}"),
        ("on: {object: ball, support: cup}",),
    ),
    Scene(
        "box on top of the one that stands on the tray",
        "two boxes are stacked on a tray",
        "objects:\n" + TRAY + "  - {name: lower, box: {size: [0.06, 0.06, 0.03]}, mass: 50 g, "
        "pose: {xyz: [0.3, 0.3, 0.035]}}\n"
        "  - {name: upper, box: {size: [0.04, 0.04, 0.03]}, mass: 50 g, "
        "pose: {xyz: [0.3, 0.3, 0.065]}}\nsteps: [{wait: 0.2 s}]\n",
        "it stands still within the tray's sides, less than 6 cm above it",
        lambda run: near(run, "upper", "tray", (0.1, 0.1, 0.06)),
        (
            "placed: {object: upper, on: tray}",
            "on: {object: upper, support: tray}",
            "on: {object: lower, support: upper}",
        ),
        ("on: {object: upper, support: lower}", "on: {object: lower, support: tray}"),
    ),
    Scene(
        "box clamped in a vice",
        "two jaws of a fixture hold a box 10 cm above the floor by friction",
        "objects:\n"
        "  - {name: jaws, static: true, friction: 1, pose: {xyz: [0.3, 0.3, 0.1]}, shapes: ["
        "{box: {size: [0.06, 0.04, 0.06]}, pose: {xyz: [0, 0.0398, 0]}}, "
        "{box: {size: [0.06, 0.04, 0.06]}, pose: {xyz: [0, -0.0398, 0]}}]}\n"
        "  - {name: cube, box: {size: [0.04, 0.04, 0.04]}, mass: 20 g, friction: 1, "
        "pose: {xyz: [0.3, 0.3, 0.1]}}\nsteps: [{wait: 0.3 s}]\n",
        "it is 5 cm above the floor, stands still, and is touched from two sides",
        lambda run: bool(place_of(run, "cube")[-1, 2] > 0.07),
        (
            "grasped: cube",
            "lifted: {object: cube, above: 1 cm}",
            "placed: {object: cube, pose: {xyz: [0.3, 0.3, 0.02]}}",
        ),
        ("in_contact: {between: [cube, jaws]}",),
    ),
    Scene(
        "box that slides fast along the floor",
        "a box slides at 1 m/s, and parts from the floor for some milliseconds again and again",
        "objects:\n" + CUBE + "steps:\n"
        "  - inject: {push: {cube: [0, 1.45, 0]}, push_duration: 50 ms}\n  - wait: 0.1 s\n",
        "at no time do they touch for 60 ms at every sample",
        lambda run: longest_touch(run, "cube", "ground_plane") < 0.06,
        ("never: {in_contact: {between: [cube, ground_plane]}, for: 60 ms}",),
        ("in_contact: {between: [cube, ground_plane]}",),
    ),
    Scene(
        "box that slides fast along a bench",
        "a box slides at 1 m/s along a bench, and parts from it again and again",
        "objects:\n  - {name: bench, static: true, box: {size: [0.2, 1, 0.1]}, "
        "pose: {xyz: [0.35, -0.2, 0.05]}}\n"
        + CUBE.replace("-0.2, 0.02", "-0.2, 0.12")
        + "steps:\n  - inject: {push: {cube: [0, 1.45, 0]}, push_duration: 50 ms}\n"
        "  - wait: 0.1 s\n",
        "at no time do they touch for 60 ms at every sample",
        lambda run: longest_touch(run, "bench", "cube") < 0.06,
        ("never: {in_contact: {between: [cube, bench]}, for: 60 ms}",),
        ("in_contact: {between: [cube, bench]}",),
    ),
    Scene(
        "box that hops",
        "four pushes let a box leave the floor for more than 10 ms each, the last one at the end",
        KNOCKS + "  - inject: {push: {cube: [0, 0, 0.6]}}\n  - wait: 70 ms\n",
        "it touches the floor for more than 0.4 s in all: too strict",
        lambda run: touches(run, "cube", "ground_plane").sum() * run.timestep > 0.4,
        (),
        ("never: {in_contact: {between: [cube, ground_plane]}, for: 0.4 s}",),
    ),
)
