"""Scenes about frames that are far from their bodies, and bodies that turn about their frames.

The truth is found from the poses of points of the bodies, here and not by the verdicts' code.
"""

from __future__ import annotations

import numpy as np

from harness.core.pose_arrays import rotate
from harness.recording.run import Run
from tests.adversarial.contact_scenes import touches
from tests.adversarial.scenes import Scene, place_of

UR = "{model: ur5e, gripper: rh_p12_rn_a, base: {xyz: [0, 0, 0.5]}}"
BENCH = """objects:
  - {name: foot, static: true, box: {size: [0.3, 0.3, 0.48]}, pose: {xyz: [0, 0, 0.24]}}
  - {name: bench, static: true, in: simulation, box: {size: [0.4, 0.5, 0.5]},
     pose: {xyz: [0.6, 0, 0.25]}}
"""
PLATE = (
    "  - {name: plate, in: simulation, box: {size: [0.2, 0.03, 0.025]}, mass: 0.4, friction: 0.5,\n"
    "     pose: {xyz: [0.55, 0, 0.5126]}}\n"
)
ON_PLATE = """steps:
  - gripper: open
  - move_to: {pose: {xyz: [0.55, 0, 0.62], rpy: [180 deg, 0, 0]}}
  - lin: {pose: {xyz: [0.55, 0, 0.522], rpy: [180 deg, 0, 0]}}
  - gripper: {named_target: closed, max_effort: 1}
"""
MAT = """  - {name: mat, static: true, in: simulation, box: {size: [0.9, 0.8, 0.002]},
     pose: {xyz: [0.4, 0, 0]}}
"""
TAKE = """steps:
  - gripper: open
  - move_to: {position: {xyz: [0.19, 0, 0.06]}, pitch: 0}
  - lin: {position: {xyz: [0.25, 0, 0.06]}, pitch: 0}
"""


def can(x: float, *, mass: float, friction: float = 1) -> str:
    """A can that stands at x = 25 cm, and whose frame is somewhere else along x."""
    ahead = 0.25 - x
    return (
        "  - name: can\n"
        "    shapes: [{cylinder: {radius: 0.02, length: 0.09},"
        f" pose: {{xyz: [{ahead:g}, 0, 0.045]}}}}]\n"
        f"    center_of_mass: [{ahead:g}, 0, 0.045]\n"
        f"    mass: {mass}\n    friction: {friction}\n    pose: {{xyz: [{x:g}, 0, 0.0012]}}\n"
    )


def ways(run: Run, name: str, points: list[tuple[float, float, float]]) -> np.ndarray:
    """Of points of an object, from where each was at first [m], shape (n, points, 3)."""
    poses = run.signals.object_poses[name]
    places = np.stack(
        [poses[:, :3] + rotate(poses[:, 3:], np.array(point)) for point in points], axis=1
    )
    return places - places[0]


def goes(run: Run, name: str) -> float:
    """The largest way of an object's origin from its start [m]."""
    return float(np.linalg.norm(place_of(run, name) - place_of(run, name)[0], axis=1).max())


FRAME_SCENES = (
    Scene(
        "plate turned where it lies",
        "the held plate lies on the bench all the time, and is turned by 80 degrees about its"
        " middle",
        BENCH
        + PLATE
        + ON_PLATE
        + "  - move_relative: {rotation: {xyz: [0, 0, 1]}, angle: 80 deg}\n",
        "the plate's origin stays where it is, within 1 cm",
        lambda run: goes(run, "plate") < 0.01,
        ("never: collision",),
        ("never: {displaced: {object: plate, at_least: 1 cm}}",),
        robot=UR,
        truth=lambda run: bool(
            (touches(run, "bench", "plate")[-1000:] > 0).any()
            and np.linalg.norm(ways(run, "plate", [(0.1, 0, 0)])[-1, 0]) > 0.08
        ),
    ),
    Scene(
        "can dragged around the arm, with its frame on the arm's axis",
        "the first joint drags the can 10 cm along the mat without raising it",
        "objects:\n"
        + MAT
        + can(0.012, mass=0.35, friction=0.1)
        + TAKE
        + "  - grasp: can\n  - ptp: {joints: {joint1: 0.45}}\n",
        "the can's origin stays where it is, within 1 cm",
        lambda run: goes(run, "can") < 0.01,
        ("never: collision",),
        ("displaced: {object: can, at_least: 6 cm}",),
        truth=lambda run: bool(
            np.linalg.norm(ways(run, "can", [(0.238, 0, 0)])[-1, 0]) > 0.06
            and touches(run, "mat", "can")[-1500:].mean() > 0.1
        ),
    ),
    Scene(
        "can raised by its frame",
        "the frame, 35 cm ahead of the can, rises by 10 cm as the wrist pitches up",
        "objects:\n" + can(0.6, mass=0.08) + TAKE + "  - grasp: can\n"
        "  - move_relative: {direction: {xyz: [0, 0, 1]}, distance: 1.5 cm}\n"
        "  - move_to: {position: {xyz: [0.25, 0, 0.075]}, pitch: -15 deg}\n  - wait: 0.3 s\n",
        "the can's origin rose by more than 7 cm",
        lambda run: bool(place_of(run, "can")[-1, 2] - place_of(run, "can")[0, 2] > 0.07),
        ("lifted: {object: can, above: 5 cm}", "displaced: {object: can, at_least: 6 cm}"),
        ("lifted: {object: can, above: 1 cm}", "grasped: can"),
        truth=lambda run: bool(
            ways(run, "can", [(-0.35, 0.02, 0), (-0.35, -0.02, 0.09)])[..., 2].max() < 0.05
        ),
    ),
    Scene(
        "can raised whose frame sinks",
        "the frame, 35 cm ahead of the can, sinks by 6 cm as the wrist pitches down",
        "objects:\n" + can(0.6, mass=0.08).replace("0.0012]", "0.0002]") + TAKE + "  - grasp: can\n"
        "  - move_relative: {direction: {xyz: [0, 0, 1]}, distance: 3 cm}\n"
        "  - move_to: {position: {xyz: [0.25, 0, 0.09]}, pitch: 15 deg}\n  - wait: 0.3 s\n",
        "the can's origin is lower than at the start: too strict",
        lambda run: bool(place_of(run, "can")[-1, 2] < place_of(run, "can")[0, 2]),
        (),
        ("lifted: {object: can, above: 1.5 cm}", "grasped: can"),
        truth=lambda run: bool(
            ways(run, "can", [(-0.35, 0, 0), (-0.35, 0, 0.09)])[-1, :, 2].min() > 0.02
        ),
    ),
    Scene(
        "rod raised at one end",
        "the hand raises one end of a rod by 5 cm; the other end stays where it lies",
        "objects:\n"
        "  - {name: shelf, static: true, box: {size: [0.36, 0.2, 0.05]}, pose: {xyz: [0.48, 0,"
        " 0.025]}}\n"
        "  - {name: rod, box: {size: [0.4, 0.035, 0.02]}, mass: 0.1, friction: 0.8,"
        " pose: {xyz: [0.44, 0, 0.06]}}\n" + TAKE + "  - grasp: rod\n"
        "  - move_relative: {direction: {xyz: [0, 0, 1]}, distance: 5 cm}\n",
        "the rod's origin moves by more than 2 cm while the rod touches the shelf: too strict",
        lambda run: goes(run, "rod") > 0.02 and bool(touches(run, "shelf", "rod")[-1] > 0),
        (),
        ("never: {collision: {between: [rod, shelf]}}",),
        truth=lambda run: bool(np.linalg.norm(ways(run, "rod", [(0.2, 0, -0.01)])[-1, 0]) < 0.015),
    ),
)
