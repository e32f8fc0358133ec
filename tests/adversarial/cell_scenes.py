"""Scenes of cells: suction cups, belts, doors and drawers, a peg and its hole, two hands."""

from __future__ import annotations

import numpy as np

from harness.recording.run import Run
from tests.adversarial.scenes import Scene, place_of, speed_at_end

CUP = "{model: suction_cup, base: {xyz: [0, 0, 0.2705], rpy: [180 deg, 0, 0]}}"
UNDER_THE_CUP = """objects:
  - {name: table, static: true, box: {size: [0.4, 0.4, 0.1]}, pose: {xyz: [0, 0, 0.1]}}
  - {name: plate, box: {size: [0.1, 0.1, 0.05]%s}, mass: %s, pose: {xyz: [%s, 0, 0.175]}}
"""
BELT = """objects:
  - {name: belt, static: true, box: {size: [0.6, 0.2, 0.02]}, pose: {xyz: [0, 0.3, 0.01]},
     surface_velocity: %s}
  - {name: wall, static: true, box: {size: [0.02, 0.2, 0.1]}, pose: {xyz: [0.15, 0.3, 0.07]}}
  - {name: cube, box: {size: [0.04, 0.04, 0.04]}, mass: 50 g, pose: {xyz: [0.05, 0.3, 0.04]}}
steps: [{wait: 1.5 s}%s]
"""
CHEST = """objects:
  - name: chest
    static: true
    box: {size: [0.3, 0.3, 0.2]}
    pose: {xyz: [0.5, 0, 0.1]}
    joints:
      - name: part
        mass: 0.6
        shapes: [{box: {size: [0.3, 0.3, 0.01]}, pose: {xyz: [0, 0, 0.11]}}]
        %s
steps: [{wait: 2 s}]
"""
LID = "hinge: {axis: [0, 1, 0], at: [0.15, 0, 0.105], range: [0, 100 deg], start: 80 deg}"
DRAWER = "slide: {axis: [-1, 0, 0], range: [0, 0.2], start: 0.15, stiffness: 20, damping: 4}"
PEG = """objects:
  - {name: block, static: true, box: {size: [80 mm, 80 mm, 50 mm], hole: {diameter: 20.2 mm,
     depth: 40 mm}}, pose: {xyz: [0.3, 0.2, 0.025]}}
  - {name: peg, cylinder: {radius: 10 mm, length: 80 mm}, mass: 0.1, pose: {xyz: [%s, 0.2, %s]}}
steps: [{wait: 0.3}]
"""
HANDS = """robots:
  left: {model: ur5e, gripper: rh_p12_rn_a, base: {xyz: [0, 0.45, 0]}}
  right: {model: ur5e, gripper: rh_p12_rn_a, base: {xyz: [0, -0.45, 0]}}
"""


def part_of(run: Run) -> np.ndarray:
    """Position of the chest's joint at every sample."""
    joint = next(each.joint for each in run.objects if each.name == "chest/part")
    poses = run.signals.object_poses
    return joint.positions(poses["chest"], poses["chest/part"])


CELL_SCENES = (
    Scene(
        "plate that only the planner has attached to a cup",
        "half of a cup's rim is over the edge of a plate, and the table under it is taken away",
        UNDER_THE_CUP % ("", 0.5, 0.04)
        + "steps: [{attach_object: plate}, {gripper: on}, {remove_object: table}, {wait: 0.2}]\n",
        "the suction is on, and the planning scene has the plate attached to it",
        lambda run: (
            run.attachments[-1].object == "plate" and np.isinf(run.attachments[-1].end_time)
        ),
        ("grasped: plate", "lifted: plate"),
        ("gripper: {named_target: on}",),
        robot=CUP,
    ),
    Scene(
        "cup over the edge of a hole",
        "the suction is on, and half of the rim is over a hole of the plate",
        UNDER_THE_CUP % (", hole: {size: [30 mm, 30 mm]}", 0.3, 0.02)
        + "steps: [{gripper: on}, {wait: 0.2}]\n",
        "the suction is on, and the cup touches the plate",
        lambda run: any("plate" in pair for pair in run.signals.contact_forces),
        ("grasped: plate",),
        ("gripper: {named_target: on}",),
        robot=CUP,
    ),
    Scene(
        "box that a wall holds on a running belt",
        "a belt runs under a box, which a wall at its end keeps where it is",
        BELT % (0.1, ""),
        "it stands still on the belt",
        lambda run: speed_at_end(run, "cube") < 0.005,
        (),
        ("in_contact: {between: [cube, belt]}", "in_contact: {between: [cube, wall]}"),
        warned=("placed: {object: cube, on: belt}",),
    ),
    Scene(
        "box at the wall of a belt that was stopped",
        "a belt has brought a box to a wall, and stands",
        BELT % (0.1, ", {conveyor: {object: belt, velocity: 0}}, {wait: 0.3 s}"),
        "it lies on a belt, so that it is not placed: too strict",
        lambda run: bool(run.signals.surfaces["belt"][0].any()),
        (),
        ("placed: {object: cube, on: belt}",),
        truth=lambda run: not run.signals.surfaces["belt"][-1].any(),
    ),
    Scene(
        "lid that fell shut",
        "a lid stood open by 80 degrees, and nothing holds it",
        CHEST % LID,
        "its largest angle is more than 60 degrees",
        lambda run: np.nanmax(part_of(run)) > 1.0,
        ("joint: {object: chest, at_least: 60 deg}",),
        ("joint: {object: chest, at_most: 2 deg}",),
    ),
    Scene(
        "lid that is falling shut",
        "a lid stood open by 80 degrees, and the run ends while it falls",
        (CHEST % LID).replace("wait: 2 s", "wait: 0.15 s"),
        "its angle at the end is more than 30 degrees",
        lambda run: part_of(run)[-1] > 0.55,
        (),
        ("always: {joint: {object: chest, at_least: 30 deg}}",),
        warned=("joint: {object: chest, at_least: 30 deg, at_most: 79 deg}",),
    ),
    Scene(
        "drawer that a spring closed",
        "a drawer stood open by 15 cm, and its spring pulls it back",
        CHEST % DRAWER,
        "its largest opening is more than 10 cm",
        lambda run: np.nanmax(part_of(run)) > 0.1,
        ("joint: {object: chest, at_least: 10 cm}",),
        ("joint: {object: chest, at_most: 2 cm}",),
    ),
    Scene(
        "peg next to its hole",
        "a peg stands on the ground next to the block with the hole",
        PEG % (0.355, 0.04),
        "its lower end is 4 cm below the block's top, and 6 cm from the hole",
        lambda run: np.linalg.norm((place_of(run, "peg") - place_of(run, "block"))[-1, :2]) < 0.06,
        ("inserted: {peg: peg, hole: block, depth: 39 mm}",),
        ("upright: peg",),
    ),
    Scene(
        "disk in its hole",
        "a disk of 15 mm has fallen into a hole of its diameter",
        (PEG % (0.3, 0.06)).replace("length: 80 mm", "length: 15 mm").replace("0.3}]", "0.6}]"),
        "the axis of its longest extent is 10 mm from the hole's: too strict",
        lambda run: abs(place_of(run, "peg")[-1, 2] - 0.0175) < 1e-3,
        (),
        ("inserted: {peg: peg, hole: block, depth: 39 mm}",),
        truth=lambda run: (
            np.linalg.norm((place_of(run, "peg") - place_of(run, "block"))[-1, :2]) < 0.5e-3
        ),
    ),
    Scene(
        "box that a steep belt raises past the hand",
        "a belt of 15 degrees carries a box upwards",
        """objects:
  - {name: belt, static: true, box: {size: [0.8, 0.15, 0.02]}, friction: 1,
     pose: {xyz: [0, 0.3, 0.15], rpy: [0, -15 deg, 0]}, surface_velocity: 20 cm/s}
  - {name: cube, box: {size: [0.04, 0.04, 0.04]}, mass: 50 g, friction: 1,
     pose: {xyz: [-0.15, 0.3, 0.141], rpy: [0, -15 deg, 0]}}
steps: [{wait: 1.2 s}]
""",
        "it is 5 cm higher than it was",
        lambda run: place_of(run, "cube")[-1, 2] > place_of(run, "cube")[0, 2] + 0.05,
        ("lifted: {object: cube, above: 5 cm}", "placed: {object: cube, on: belt}"),
        ("on: {object: cube, support: belt}",),
    ),
    Scene(
        "box that slips on a belt",
        "a smooth belt runs at 0.3 m/s under a box, and stops",
        """objects:
  - {name: belt, static: true, box: {size: [1.2, 0.2, 0.02]}, pose: {xyz: [0, 0.3, 0.01]},
     surface_velocity: 0, friction: 0.02}
  - {name: cube, box: {size: [0.04, 0.04, 0.04]}, mass: 50 g, pose: {xyz: [-0.4, 0.3, 0.04]}}
steps:
  - conveyor: {object: belt, velocity: 0.3, ramp: 0.1}
  - {wait: 1 s, id: ride}
  - conveyor: {object: belt, velocity: 0, ramp: 0.1}
  - wait: 20 ms
""",
        "the belt had its speed for a second, and stands at the end",
        lambda run: (
            np.sum(run.signals.surfaces["belt"][:, 0] > 0.299) * run.timestep > 0.9
            and not run.signals.surfaces["belt"][-1].any()
        ),
        (
            "{formula: 'always speed(cube) > 0.29 m/s', during: ride}",
            "placed: {object: cube, on: belt}",
        ),
        ("formula: eventually surface_velocity(belt) > 0.299 m/s",),
    ),
    Scene(
        "rod that both hands hold",
        "the right hand has closed on the rod, and the left one has not let go",
        """objects:
  - {name: rod, box: {size: [4 cm, 24 cm, 4 cm]}, pose: {xyz: [0.5, 0.3, 0.02]}, mass: 0.1}
steps:
  - {pick: {object: rod, grasp_pose: {frame: rod, xyz: [0, 8 cm, 0]}}, robot: left}
  - {lin: {link: rod, pose: {xyz: [0.5, 0.0, 0.3]}}, robot: left}
  - {gripper: open, robot: right}
  - move_to: {pose: {frame: rod, xyz: [0, -8 cm, 10 cm], rpy: [180 deg, 0, 90 deg]}}
    robot: right
  - lin: {pose: {frame: rod, xyz: [0, -8 cm, 0], rpy: [180 deg, 0, 90 deg]}}
    robot: right
  - {grasp: rod, robot: right}
""",
        "the right hand holds the rod, so that it has been handed over",
        lambda run: any(
            {"rod"} & {*pair} and any(name.startswith("right_") for name in pair) and force[-1] > 1
            for pair, force in run.signals.contact_forces.items()
        ),
        ("released: {object: rod, by: left}", "released: rod"),
        ("grasped: {object: rod, by: right}", "grasped: {object: rod, by: left}"),
        robot=HANDS,
    ),
)
