"""Scenes about holding and shapes: excused contacts, struck objects, pictures, hidden overlaps.

Each scene's truth is established from poses alone, which are MuJoCo's raw state: by a balance of
forces, mass times acceleration less the weight, or by geometry.
"""

from __future__ import annotations

import numpy as np

from harness.recording.run import Run
from tests.adversarial.scenes import AT_BOX, RED_BOX, Scene, near, place_of, rose, touched

GRASP = AT_BOX.replace("- gripper: {position: -0.01, max_effort: 10}", "- grasp: red_box")
FIRMLY = GRASP.replace("- grasp: red_box", "- grasp: {object: red_box, max_effort: 200}")
UP = "  - move_relative: {direction: {xyz: [0, 0, 1]}, distance: 6 cm}\n"
TIPS = "[[gripper_left_link, big], [gripper_right_link, big]]"


def acceleration(run: Run, name: str) -> np.ndarray:
    """Of an object's origin [m/s^2], shape (n - 2, 3)."""
    return np.diff(place_of(run, name), 2, axis=0) / run.timestep**2


def in_tcp_moved(run: Run, name: str, samples: slice) -> float:
    """How far an object moved with respect to the TCP's origin [m]."""
    apart = place_of(run, name)[samples] - run.signals.tcp_pose[samples, :3]
    return float(np.linalg.norm(apart - apart[0], axis=1).max())


def touches(run: Run, first: str, second: str) -> np.ndarray:
    """Force between two bodies at each sample [N]."""
    forces = run.signals.contact_forces
    return forces.get((first, second), forces.get((second, first), np.zeros(1)))


def mass_of(run: Run, name: str) -> float:
    """Of an object [kg]."""
    return next(record.mass for record in run.objects if record.name == name)


def presses_far_beyond_weight(run: Run, name: str, other: str) -> bool:
    """At rest for a second: all but its weight comes from the hand, and the other body bears it."""
    force = touches(run, name, other)[-2500:]
    still = np.abs(acceleration(run, name)[-2500:]).max(axis=1) < 0.5
    pressed = force[2:][still[: len(force) - 2]]
    return bool(np.median(pressed[pressed > 0]) > 5 * 9.8 * mass_of(run, name))


def robot_never_touches(run: Run, name: str) -> bool:
    """No link of the robot touches a body."""
    return not touched(run, name, at_end=False)


CONTACT_SCENES = (
    Scene(
        "held box pressed onto a hidden plate",
        "the gripper presses the box that it holds onto a plate that the planner does not know",
        "objects:\n" + RED_BOX + "  - {name: plate, in: simulation, static: true, "
        "box: {size: [0.1, 0.1, 0.03]}, pose: {xyz: [0.25, 0.12, 0.005]}}\nsteps:"
        + FIRMLY
        + UP
        + "  - move_to: {position: {xyz: [0.25, 0.12, 0.12]}, pitch: 0}\n"
        "  - lin: {position: {xyz: [0.25, 0.12, 0.077]}}\n  - wait: 1 s\n"
        "  - release: red_box\n  - wait: 0.3 s\n",
        "no link of the robot ever touches the plate",
        lambda run: robot_never_touches(run, "plate"),
        ("never: collision",),
        ("never: {collision: {between: [robot, plate]}}",),
        truth=lambda run: bool((touches(run, "plate", "red_box") > 20 * 0.49).sum() > 500),
    ),
    Scene(
        "gripped box rammed into what it stands on",
        "the closed hand pushes the box down onto the stand that the box stood on all along",
        "objects:\n" + RED_BOX.replace("0.041", "0.061") + "  - {name: stand, in: simulation, "
        "static: true, box: {size: [0.06, 0.06, 0.02]}, pose: {xyz: [0.25, 0, 0.01]}}\nsteps:"
        + FIRMLY.replace("0.06]", "0.08]")
        + "  - lin: {position: {xyz: [0.25, 0, 0.078]}}\n  - wait: 1 s\n"
        + UP,
        "the box touches nothing that it did not touch before it was gripped",
        lambda run: robot_never_touches(run, "stand"),
        ("never: collision",),
        ("never: {collision: {between: [robot, stand]}}",),
        truth=lambda run: bool((touches(run, "red_box", "stand") > 20 * 0.49).sum() > 500),
    ),
    Scene(
        "gripped box pressed onto its stand with less than the grip",
        "the closed hand leans on the stand that the box stood on, with a tenth of what it grips",
        "objects:\n" + RED_BOX.replace("0.041", "0.061") + "  - {name: stand, in: simulation, "
        "static: true, box: {size: [0.06, 0.06, 0.02]}, pose: {xyz: [0.25, 0, 0.01]}}\nsteps:"
        + FIRMLY.replace("0.06]", "0.08]")
        + "  - lin: {position: {xyz: [0.25, 0, 0.0794]}}\n  - wait: 0.5 s\n"
        + UP,
        "the box touches nothing that it did not touch before it was gripped",
        lambda run: robot_never_touches(run, "stand"),
        ("never: collision",),
        ("never: {collision: {between: [robot, stand]}}",),
        truth=lambda run: bool(
            4 * 0.49 < np.median(touches(run, "red_box", "stand")[-1250:-850]) < 20
        ),
    ),
    Scene(
        "held box dragged along a rug",
        "the gripper carries the box 8 cm aside without taking it off the rug",
        "objects:\n" + RED_BOX.replace("0.041", "0.0417") + "  - {name: rug, in: simulation, "
        "static: true, box: {size: [0.3, 0.4, 0.003]}, pose: {xyz: [0.25, 0, 0]}}\nsteps:"
        + GRASP
        + "  - lin: {position: {xyz: [0.25, 0.08, 0.06]}}\n  - release: red_box\n",
        "the box touches nothing that it did not touch before it was gripped",
        lambda run: robot_never_touches(run, "rug"),
        ("never: collision",),
        ("displaced: {object: red_box, at_least: 7 cm}",),
        truth=lambda run: bool(
            np.ptp(place_of(run, "red_box")[touches(run, "red_box", "rug") > 0, 1]) > 0.02
        ),
    ),
    Scene(
        "welded box that no finger touches hits a beam",
        "`mode: weld` fixes the box to the palm, the fingers open, the box is pushed into a beam",
        "objects:\n" + RED_BOX + "  - {name: beam, in: simulation, static: true, "
        "box: {size: [0.02, 0.3, 0.03]}, pose: {xyz: [0.31, 0, 0.07]}}\nsteps:"
        + GRASP.replace("grasp: red_box", "grasp: {object: red_box, mode: weld}")
        + UP
        + "  - gripper: open\n"
        "  - move_relative: {direction: {xyz: [1, 0, 0]}, distance: 3.1 cm}\n  - wait: 0.2 s\n",
        "no finger holds the box, and no link of the robot touches the beam",
        lambda run: robot_never_touches(run, "beam") and not touched(run, "red_box"),
        ("never: collision",),
        ("never: {collision: {between: [robot, beam]}}",),
        truth=lambda run: bool(touches(run, "beam", "red_box").max() > 5 * 0.49),
    ),
    Scene(
        "box put down as usual",
        "the box is lifted, carried aside, set down on the floor and let go",
        "objects:\n" + RED_BOX + "steps:"
        + GRASP
        + UP
        + "  - move_to: {position: {xyz: [0.25, 0.1, 0.12]}, pitch: 0}\n"
        "  - lin: {position: {xyz: [0.25, 0.1, 0.0625]}}\n  - release: red_box\n"
        "  - wait: 0.3 s\n",
        "a contact of the box exceeds eight times its weight: too strict",
        lambda run: bool(touches(run, "ground_plane", "red_box").max() > 8 * 0.49),
        (),
        ("never: collision", "placed: red_box"),
        truth=lambda run: bool(np.abs(acceleration(run, "red_box")[-200:]).max() < 0.5),
    ),
    Scene(
        "box lifted off the bench that the fingers press it onto",
        "closing fingers push the box onto the bench, and it is lifted before that has decayed",
        "objects:\n  - {name: bench, static: true, pose: {xyz: [0.5, 0, 0.1]}, "
        "box: {size: [0.4, 0.8, 0.2]}}\n  - {name: part, pose: {xyz: [0.45, 0.1, 0.23]}, "
        "box: {size: [0.03, 0.03, 0.06]}, mass: 0.2, friction: 0.8}\nsteps: [{pick: part}]\n",
        "after the gripper has closed, the bench bears more than twice the weight: too strict",
        lambda run: bool(
            touches(run, "bench", "part")[run.steps[-1].start_index :].max() > 2 * 1.96
        ),
        (),
        ("never: collision", "lifted: part"),
        truth=lambda run: bool(rose(run, "part", 0.05) and touches(run, "bench", "part")[-1] == 0),
        robot="{model: ur5e, gripper: rh_p12_rn_a}",
    ),
    Scene(
        "ball shot up through the half-open hand",
        "a ball flies between the fingers, touches both for 2 ms and flies on",
        "objects:\n  - {name: ball, sphere: {radius: 0.02}, mass: 200 g, friction: 0.02, "
        "in: simulation, pose: {xyz: [0.286, 0, 0.02]}}\n"
        "steps:\n  - gripper: {position: -0.0018}\n"
        "  - inject: {push: {ball: [0, 0, 30]}, push_duration: 30 ms}\n  - wait: 0.3 s\n",
        "at some moment both fingers touch it, and it is 5 cm above its start",
        lambda run: rose(run, "ball", 0.05) and touched(run, "ball", at_end=False),
        ("eventually: {grasped: ball}", "lifted: {object: ball, above: 5 mm}"),
        ("in_contact: {between: [gripper, ball]}",),
        truth=lambda run: bool(np.abs(acceleration(run, "ball")[-100:, 2] + 9.8).max() < 0.1),
    ),
    Scene(
        "ball thrown up that lands on the fingers",
        "a ball is thrown past the open hand and falls onto the fingers, which have closed halfway",
        "objects:\n  - {name: ball, sphere: {radius: 0.02}, mass: 30 g, friction: 0.5, "
        "in: simulation, pose: {xyz: [0.28, 0, 0.02]}}\n"
        "steps:\n  - inject: {push: {ball: [0, 0, 4.6]}, push_duration: 30 ms}\n"
        "  - gripper: {position: -0.0045}\n  - wait: 2 s\n",
        "it rests 15 cm above its start and touches the gripper alone",
        lambda run: rose(run, "ball", 0.15) and touched(run, "ball"),
        (
            "lifted: {object: ball, above: 5 cm}",
            "lifted: {object: ball, above: 5 cm, cradled: true}",
        ),
        ("displaced: {object: ball, at_least: 15 cm}",),
        truth=lambda run: bool(np.ptp(run.signals.tcp_pose[:, 2]) < 0.005),
    ),
    Scene(
        "ball cradled on two half-open fingers",
        "a ball lies in the gap of fingers that stand still, while the arm rises",
        "objects:\n  - {name: ball, sphere: {radius: 0.03}, mass: 60 g, friction: 0.3, "
        "in: simulation, pose: {xyz: [0.276, 0, 0.2458]}}\n"
        "steps:\n  - gripper: {position: 0.004}\n  - wait: 0.3 s\n" + UP + "  - wait: 0.5 s\n",
        "both fingers press it from either side, and it rose by 4 cm",
        lambda run: rose(run, "ball", 0.04) and touched(run, "ball"),
        ("grasped: ball", "lifted: {object: ball, above: 4 cm}"),
        ("lifted: {object: ball, above: 4 cm, cradled: true}",),
        truth=lambda run: bool(
            np.ptp(run.signals.joint_positions[-1000:, -2:], axis=0).max() < 1e-4
        ),
    ),
    Scene(
        "ball on a jammed gripper",
        "a ball lies in the gap of fingers that are blocked and shall close, while the arm rises",
        "objects:\n  - {name: ball, sphere: {radius: 0.03}, mass: 300 g, friction: 0.1, "
        "in: simulation, pose: {xyz: [0.276, 0, 0.2458]}}\n"
        "steps:\n  - gripper: {position: 0.004}\n  - wait: 0.3 s\n"
        "  - inject: {joint_stall: gripper_left_joint}\n  - gripper: close\n" + UP
        + "  - wait: 0.3 s\n",
        "the gripper closes, both fingers press it from either side, and it rose by 4 cm",
        lambda run: rose(run, "ball", 0.04) and touched(run, "ball"),
        ("grasped: ball", "lifted: {object: ball, above: 4 cm}"),
        ("lifted: {object: ball, above: 4 cm, cradled: true}",),
        truth=lambda run: bool(
            np.ptp(run.signals.joint_positions[-1000:, -2:], axis=0).max() < 1e-3
        ),
    ),
    Scene(
        "ball on fingers that grip a rod",
        "the fingers grip a rod, and a ball lies above it in the gap between them",
        "objects:\n  - {name: post, static: true, in: simulation, "
        "box: {size: [0.01, 0.02, 0.182]}, pose: {xyz: [0.286, 0, 0.091]}}\n"
        "  - {name: rod, in: simulation, box: {size: [0.016, 0.044, 0.01]}, mass: 20 g, "
        "friction: 1, pose: {xyz: [0.286, 0, 0.1871]}}\n"
        "steps:\n  - gripper: {position: -0.01, max_effort: 15}\n"
        "  - add_object: {name: ball, in: simulation, mass: 90 g, friction: 0.2, "
        "pose: {xyz: [0.286, 0, 0.2335]}, sphere: {radius: 0.0275}}\n  - wait: 0.3 s\n" + UP
        + "  - wait: 0.3 s\n",
        "the fingers press with 15 N, and both touch the ball, which rose by 4 cm",
        lambda run: np.ptp(place_of(run, "ball")[-1000:, 2]) > 0.04 and touched(run, "ball"),
        ("grasped: ball", "lifted: {object: ball, above: 4 cm}"),
        ("grasped: rod", "lifted: {object: ball, above: 4 cm, cradled: true}"),
        truth=lambda run: touches(run, "gripper_left_link", "ball")[-500:].max() < 2.0,
    ),
    Scene(
        "ball gripped below its middle",
        "a ball lies in the gap of the fingers, which close with 1.4 N, while the arm rises",
        "objects:\n  - {name: ball, sphere: {radius: 0.03}, mass: 60 g, friction: 1, "
        "in: simulation, pose: {xyz: [0.276, 0, 0.2458]}}\n"
        "steps:\n  - gripper: {position: 0.004}\n  - wait: 0.3 s\n"
        "  - gripper: {position: -0.01, max_effort: 1.4}\n" + UP + "  - wait: 0.3 s\n",
        "normal forces alone would carry it: too strict",
        lambda run: touched(run, "ball"),
        (),
        ("grasped: ball", "lifted: {object: ball, above: 4 cm}"),
        truth=lambda run: touches(run, "gripper_left_link", "ball")[-500:].min() > 0.5,
    ),
    Scene(
        "plank across both fingers",
        "a plank lies on both fingers of the open gripper like on a shelf, while the arm rises",
        "objects:\n  - {name: plank, box: {size: [0.03, 0.11, 0.004]}, mass: 30 g, friction: 2, "
        "in: simulation, pose: {xyz: [0.286, 0, 0.2168]}}\nsteps:\n  - wait: 0.2 s\n"
        + UP
        + "  - wait: 0.3 s\n",
        "both fingers touch it, nothing else does, and it rose by 5 cm",
        lambda run: rose(run, "plank", 0.05) and touched(run, "plank"),
        ("grasped: plank", "lifted: {object: plank, above: 5 cm}"),
        ("displaced: {object: plank, at_least: 5 cm}",),
        truth=lambda run: bool(np.ptp(run.signals.joint_positions[:, -2:], axis=0).max() < 1e-3),
    ),
    Scene(
        "box lifted with a jerk",
        "the arm lifts the box as fast as it can",
        "objects:\n" + RED_BOX + "steps:"
        + GRASP
        + "  - move_relative: {direction: {xyz: [0, 0, 1]}, distance: 8 cm}\n"
        "    planning: {max_velocity_scaling_factor: 1, max_acceleration_scaling_factor: 1}\n"
        "  - wait: 0.3 s\n",
        "at some sample in the air the force on it is less than half of its weight: too strict",
        lambda run: bool((acceleration(run, "red_box")[:, 2] < -4.9).any()),
        (),
        ("lifted: {object: red_box, above: 7 cm}", "grasped: red_box", "never: collision"),
        truth=lambda run: in_tcp_moved(run, "red_box", slice(-1000, None)) < 0.002,
    ),
    Scene(
        "closed tips on a larger box",
        "the tips press on top of a box and close there; the step `grasp` fails as expected",
        "objects:\n  - {name: big, box: {size: [0.1, 0.12, 0.04]}, mass: 500 g, friction: 1, "
        "pose: {xyz: [0.18, 0, 0.02]}}\nsteps:\n  - gripper: {position: 0.0}\n"
        "  - move_to: {position: {xyz: [0.18, 0, 0.10]}, pitch: 1.4}\n"
        f"  - allow_collisions:\n      pairs: {TIPS}\n      during:\n"
        "        - move_relative: {direction: {xyz: [0, 0, -1]}, distance: 3.75 cm}\n"
        "        - grasp: big\n          expect_error: CONTROL_FAILED\n",
        "both fingers touch it when the gripper has closed",
        lambda run: all(
            touches(run, f"gripper_{side}_link", "big")[-1] > 0 for side in ("left", "right")
        ),
        ("grasped: big", "lifted: {object: big, above: 1 mm}"),
        ("in_contact: {between: [gripper, big]}",),
        truth=lambda run: bool(np.ptp(place_of(run, "big")[:, 2]) < 0.002),
    ),
    Scene(
        "closed tips against the front of a crate",
        "the tips lean on a crate's front and close there; the step `grasp` fails as expected",
        "objects:\n  - {name: big, box: {size: [0.1, 0.12, 0.12]}, mass: 8 kg, friction: 1, "
        "pose: {xyz: [0.35, 0, 0.06]}}\nsteps:\n  - gripper: {position: 0.0}\n"
        "  - move_to: {position: {xyz: [0.24, 0, 0.06]}, pitch: 0}\n"
        f"  - allow_collisions:\n      pairs: {TIPS}\n      during:\n"
        "        - lin: {position: {xyz: [0.28, 0, 0.06]}}\n"
        "        - grasp: big\n          expect_error: CONTROL_FAILED\n",
        "both fingers touch it when the gripper has closed",
        lambda run: all(
            touches(run, f"gripper_{side}_link", "big")[-1] > 0 for side in ("left", "right")
        ),
        ("grasped: big",),
        ("in_contact: {between: [gripper, big]}",),
        truth=lambda run: bool(np.abs(acceleration(run, "big")[-50:]).max() < 0.5),
    ),
    Scene(
        "ball gripped above its middle",
        "the pads grip a ball of 5 cm at places 4.6 cm apart, and lift it",
        "objects:\n  - {name: ball, sphere: {radius: 0.025}, mass: 50 g, friction: 1, "
        "pose: {xyz: [0.25, 0, 0.043]}}\n  - {name: ring, static: true, "
        "box: {size: [0.02, 0.02, 0.018]}, pose: {xyz: [0.25, 0, 0.009]}}\n"
        "steps:\n  - gripper: open\n  - move_to: {position: {xyz: [0.2, 0, 0.07]}, pitch: 0}\n"
        "  - lin: {position: {xyz: [0.25, 0, 0.07]}}\n  - grasp: ball\n" + UP + "  - wait: 0.3 s\n",
        "the gap between the fingers is smaller than the ball: too strict",
        lambda run: bool(2 * (0.021 + run.signals.joint_positions[-1, -2]) < 0.047),
        (),
        ("grasped: ball", "lifted: {object: ball, above: 5 cm}", "never: collision"),
        truth=lambda run: bool(
            rose(run, "ball", 0.05) and in_tcp_moved(run, "ball", slice(-1000, None)) < 0.002
        ),
    ),
    Scene(
        "ball next to a tray that is shown larger",
        "the tray is 10 cm wide and shown 40 cm wide; the ball lies 7 cm from it, on the floor",
        "objects:\n  - {name: tray, static: true, box: {size: [0.1, 0.1, 0.02]}, "
        "pose: {xyz: [0.3, 0.3, 0.01]}, "
        "visuals: [{box: {size: [0.4, 0.4, 0.2]}, pose: {xyz: [0, 0, 0.09]}}]}\n"
        "  - {name: ball, sphere: {radius: 0.02}, mass: 50 g, pose: {xyz: [0.42, 0.3, 0.02]}}\n"
        "steps: [{wait: 0.5 s}]\n",
        "its origin is inside what is shown of the tray",
        lambda run: near(run, "ball", "tray", (0.2, 0.2, 0.2)),
        ("in: {object: ball, container: tray}", "on: {object: ball, support: tray}"),
        ("on: {object: ball, support: ground_plane}",),
        truth=lambda run: bool(place_of(run, "ball")[-1, 0] - 0.02 > 0.3 + 0.05),
    ),
    Scene(
        "post that is shown thinner than it is",
        "a post of 20 cm is shown as a pole of 2 cm, 14 cm from the gripper",
        "objects:\n  - {name: post, static: true, box: {size: [0.2, 0.2, 0.4]}, "
        "pose: {xyz: [0.46, 0, 0.2]}, visuals: [{box: {size: [0.02, 0.02, 0.4]}}]}\n"
        "steps: [{wait: 0.1 s}]\n",
        "the TCP stays more than 15 cm away from what is shown",
        lambda run: bool(0.45 - run.signals.tcp_pose[:, 0].max() > 0.15),
        ("always: {clearance: {between: [robot, post], at_least: 10 cm}}",),
        ("always: {clearance: {between: [robot, post], at_least: 3 cm}}", "never: collision"),
        truth=lambda run: bool(0.36 - run.signals.tcp_pose[:, 0].max() < 0.1),
    ),
    Scene(
        "ball shown as a balloon",
        "a ball of 4 cm that is shown as one of 12 cm is gripped and lifted",
        "objects:\n  - {name: ball, sphere: {radius: 0.02}, mass: 50 g, friction: 1, "
        "pose: {xyz: [0.25, 0, 0.06]}, visuals: [{sphere: {radius: 0.06}}]}\n"
        "  - {name: stand, static: true, box: {size: [0.02, 0.02, 0.04]}, "
        "pose: {xyz: [0.25, 0, 0.02]}}\nsteps:" + GRASP.replace("red_box", "ball")
        + UP + "  - wait: 0.3 s\n",
        "the gap between the fingers is smaller than the ball that is shown: too strict",
        lambda run: bool(2 * (0.021 + run.signals.joint_positions[-1, -2]) < 0.12),
        (),
        ("grasped: ball", "lifted: {object: ball, above: 5 cm}", "never: collision"),
        truth=lambda run: bool(
            rose(run, "ball", 0.05) and in_tcp_moved(run, "ball", slice(-1000, None)) < 0.002
        ),
    ),
)  # fmt: skip
"""Scenes in which `expect` is empty are those in which a rule must not fire: the naive check is
too strict there."""
