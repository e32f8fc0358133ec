"""Scenes whose naive verdict is wrong: real physics, a naive check and the harness' verdict.

A naive check is a line such as success functions are full of: a height against a number, a
distance between two origins, any contact with the gripper. It passes in every scene here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from harness.recording.run import Run

HEAD = """
scenario: {title}
{robot}
world: {world}
"""
RED_BOX = "  - {name: red_box, box: {size: [0.04, 0.04, 0.08]}, pose: {xyz: [0.25, 0, 0.041]}, "
RED_BOX += "mass: 50 g, friction: 1}\n"
TRAY = (
    "  - {name: tray, static: true, box: {size: [0.2, 0.2, 0.02]}, pose: {xyz: [0.3, 0.3, 0.01]}}"
)
TRAY += "\n"
AT_BOX = """
  - gripper: open
  - move_to: {position: {xyz: [0.19, 0, 0.06]}, pitch: 0}
  - lin: {position: {xyz: [0.25, 0, 0.06]}}
  - gripper: {position: -0.01, max_effort: 10}
"""


@dataclass(frozen=True)
class Scene:
    """One lie.

    Attributes:
        title: What the scene is.
        happens: What the physics does.
        text: The scenario, but for its head and its expectations.
        naive: The check as it is often written, in words.
        says: The naive check on the recorded run.
        expect: Our expectations, YAML; every one must be refuted. Empty where the naive check is
            too strict, or where a rule must not refute anything.
        stays: Expectations that hold in the same run, so that nothing is refused wholesale.
        world: Its world.
        warned: Expectations that hold with a warning, and fail a strict run.
        robot: Its robot, or its `robots:`.
        files: Text of the files that it names.
        truth: What happens, from poses and forces alone; it shares no code with the verdicts.
    """

    title: str
    happens: str
    text: str
    naive: str
    says: Callable[[Run], bool]
    expect: tuple[str, ...]
    stays: tuple[str, ...] = ()
    world: str = "empty"
    warned: tuple[str, ...] = ()
    truth: Callable[[Run], bool] = lambda _: True
    robot: str = "{model: open_manipulator_x, base: {xyz: [0, 0, 0.01]}}"
    files: Mapping[str, str] = field(default_factory=dict)

    def scenario(self, folder_world: str) -> str:
        """The scenario file."""
        world = folder_world if self.world == "weightless" else self.world
        lines = "".join(f"  - {each}\n" for each in (*self.expect, *self.warned, *self.stays))
        robot = self.robot if self.robot.startswith("robots:") else f"robot: {self.robot}"
        return (
            HEAD.format(title=self.title, world=world, robot=robot)
            + self.text
            + "expect:\n"
            + lines
        )


WEIGHTLESS = "world: weightless\nphysics: {gravity: [0, 0, 0]}\nobjects: []\n"


def place_of(run: Run, name: str) -> np.ndarray:
    """Where an object was, shape (n, 3)."""
    return run.signals.object_poses[name][:, :3]


def touched(run: Run, name: str, *, at_end: bool = True) -> bool:
    """Whether anything of the robot touches an object."""
    links = set(run.robot.link_names)
    pairs = [pair for pair in run.signals.contact_forces if name in pair and set(pair) & links]
    forces = [run.signals.contact_forces[pair] for pair in pairs]
    return any((force[-50:] if at_end else force).max() > 0 for force in forces)


def speed_at_end(run: Run, name: str) -> float:
    """Of an object's origin [m/s]."""
    return float(np.linalg.norm(np.diff(place_of(run, name)[-2:], axis=0)) / run.timestep)


def rose(run: Run, name: str, by: float) -> bool:
    """The highest point against the start: robosuite's Lift, LIBERO's Up."""
    z = place_of(run, name)[:, 2]
    return bool(z.max() - z[0] > by)


def near(run: Run, name: str, other: str, within: tuple[float, float, float]) -> bool:
    """Origins near each other at the end."""
    gap = np.abs(place_of(run, name)[-1] - place_of(run, other)[-1])
    return bool((gap < np.array(within)).all())


SCENES = (
    Scene(
        "object hovers 5 mm above the tray",
        "without gravity a box stays where it was put, 5 mm above the tray, and touches nothing",
        "objects:\n" + TRAY + "  - {name: cube, box: {size: [0.04, 0.04, 0.04]}, "
        "pose: {xyz: [0.3, 0.3, 0.045]}}\nsteps: [{wait: 0.5 s}]\n",
        "origin within the tray's sides and less than 6 cm above it",
        lambda run: near(run, "cube", "tray", (0.1, 0.1, 0.06)),
        ("placed: {object: cube, on: tray}", "on: {object: cube, support: tray}"),
        ("static: cube", "never: {in_contact: {between: [cube, any]}}"),
        "weightless",
    ),
    Scene(
        "box leans against the gripper, which grasps nothing",
        "a slab falls against the closed gripper and rests there, tilted",
        "objects:\n  - {name: slab, box: {size: [0.02, 0.1, 0.3]}, mass: 100 g, "
        "pose: {xyz: [0.42, 0, 0.152], rpy: [0, -0.12, 0]}}\n"
        "steps:\n  - gripper: close\n  - move_to: {position: {xyz: [0.27, 0, 0.15]}, pitch: 0}\n"
        "  - wait: 1.5 s\n",
        "the gripper is closed and touches it",
        lambda run: touched(run, "slab"),
        ("grasped: slab", "lifted: {object: slab, above: 1 mm}", "upright: slab"),
        ("in_contact: {between: [gripper, slab]}",),
    ),
    Scene(
        "object lifted on one finger",
        "a plate lies on one finger of the open gripper while the arm rises",
        "objects:\n  - {name: plate, box: {size: [0.03, 0.014, 0.004]}, mass: 10 g, friction: 2, "
        "in: simulation, pose: {xyz: [0.286, 0.0303, 0.2168]}}\n"
        "steps:\n  - wait: 0.2 s\n"
        "  - move_relative: {direction: {xyz: [0, 0, 1]}, distance: 6 cm}\n  - wait: 0.3 s\n",
        "it rose by 5 cm and touches the gripper",
        lambda run: rose(run, "plate", 0.05) and touched(run, "plate"),
        ("lifted: {object: plate, above: 5 cm}", "grasped: plate"),
        ("displaced: {object: plate, at_least: 5 cm}",),
    ),
    Scene(
        "object pushed off the table",
        "a push throws the box off the edge, and it falls 30 cm",
        "objects:\n  - {name: table, static: true, box: {size: [0.3, 0.3, 0.3]}, "
        "pose: {xyz: [0.6, 0, 0.15]}}\n"
        "  - {name: cube, box: {size: [0.04, 0.04, 0.04]}, mass: 60 g, friction: 0.2, "
        "pose: {xyz: [0.72, 0, 0.321]}}\n"
        "steps:\n  - wait: 0.1 s\n  - inject: {push: {cube: [2, 0, 0]}}\n  - wait: 1 s\n",
        "its height changed by more than 5 cm",
        lambda run: bool(np.ptp(place_of(run, "cube")[:, 2]) > 0.05),
        ("lifted: {object: cube, above: 5 cm}", "on: {object: cube, support: table}"),
        ("displaced: {object: cube, at_least: 20 cm}",),
    ),
    Scene(
        "object that was never there",
        "the step that adds the box is not reached",
        "steps:\n  - move_to: {position: {xyz: [2, 0, 0.1]}}\n"
        "  - add_object: {name: ghost, box: {size: [0.04, 0.04, 0.04]}, "
        "pose: {xyz: [0.3, 0.2, 0.02]}}\n  - wait: 0.2 s\n",
        "it never fell below the floor, and never touched the robot",
        lambda run: not touched(run, "ghost", at_end=False),
        (
            "static: ghost",
            "never: {displaced: ghost}",
            "released: ghost",
            "formula: always z(ghost) > -1 cm",
        ),
        (),
    ),
    Scene(
        "object held by its end and swinging",
        "a rod hangs on a ball between the pads and swings about it while it is lifted",
        "objects:\n  - name: rod\n    mass: 40 g\n    friction: {sliding: 1, torsional: 0.0001}\n"
        "    pose: {xyz: [0.25, 0, 0.06]}\n    shapes:\n"
        "      - {sphere: {radius: 0.014}}\n"
        "      - {box: {size: [0.12, 0.01, 0.01]}, pose: {xyz: [0.07, 0, 0]}}\n"
        "  - {name: stand, static: true, box: {size: [0.05, 0.05, 0.054]}, "
        "pose: {xyz: [0.36, 0, 0.027]}}\n"
        "  - {name: prop, static: true, box: {size: [0.03, 0.01, 0.045]}, "
        "pose: {xyz: [0.25, 0, 0.0225]}}\n"
        "steps:" + AT_BOX + "  - move_relative: {direction: {xyz: [0, 0, 1]}, distance: 8 cm}\n"
        "  - wait: 0.2 s\n",
        "the gripper touches it at the end, and it rose by 5 cm",
        lambda run: touched(run, "rod") and rose(run, "rod", 0.05),
        ("grasped: rod",),
        ("in_contact: {between: [gripper, rod]}",),
    ),
    Scene(
        "container tipped over with the object in it",
        "a cup lies on its side, and the ball lies in it",
        "objects:\n  - name: cup\n    mass: 200 g\n    pose: {xyz: [0.3, 0.2, 0.046], "
        "rpy: [0, 1.5707963, 0]}\n    shapes:\n"
        "      - {box: {size: [0.09, 0.09, 0.005]}, pose: {xyz: [0, 0, -0.05]}}\n"
        "      - {box: {size: [0.005, 0.09, 0.1]}, pose: {xyz: [0.0425, 0, 0]}}\n"
        "      - {box: {size: [0.005, 0.09, 0.1]}, pose: {xyz: [-0.0425, 0, 0]}}\n"
        "      - {box: {size: [0.09, 0.005, 0.1]}, pose: {xyz: [0, 0.0425, 0]}}\n"
        "      - {box: {size: [0.09, 0.005, 0.1]}, pose: {xyz: [0, -0.0425, 0]}}\n"
        "  - {name: ball, sphere: {radius: 0.015}, mass: 20 g, pose: {xyz: [0.28, 0.2, 0.025]}}\n"
        "steps: [{wait: 1 s}]\n",
        "the ball is less than 5 cm from the cup's middle",
        lambda run: near(run, "ball", "cup", (0.05, 0.05, 0.05)),
        ("in: {object: ball, container: cup}", "upright: cup"),
        ("on: {object: ball, support: cup}",),
    ),
    Scene(
        "two objects swapped",
        "each of two boxes rests on the other one's pad",
        "objects:\n"
        "  - {name: pad_a, static: true, box: {size: [0.1, 0.1, 0.01]}, "
        "pose: {xyz: [0.3, 0.2, 0.005]}}\n"
        "  - {name: pad_b, static: true, box: {size: [0.1, 0.1, 0.01]}, "
        "pose: {xyz: [0.3, -0.2, 0.005]}}\n"
        "  - {name: box_a, box: {size: [0.04, 0.04, 0.04]}, pose: {xyz: [0.3, -0.2, 0.031]}}\n"
        "  - {name: box_b, box: {size: [0.04, 0.04, 0.04]}, pose: {xyz: [0.3, 0.2, 0.031]}}\n"
        "steps: [{settle: {}}]\n",
        "there is a box on each pad",
        lambda run: all(
            any(near(run, box, pad, (0.05, 0.05, 0.05)) for box in ("box_a", "box_b"))
            for pad in ("pad_a", "pad_b")
        ),
        ("placed: {object: box_a, on: pad_a}", "on: {object: box_b, support: pad_b}"),
        ("on: {object: box_a, support: pad_b}",),
        warned=("placed: {object: box_a, on: pad_b}",),
    ),
    Scene(
        "contact for one sample",
        "the run ends at the sample at which a falling ball first touches the tray",
        "objects:\n" + TRAY + "  - {name: ball, sphere: {radius: 0.02}, mass: 20 g, "
        "pose: {xyz: [0.3, 0.3, 0.09]}}\nsteps: [{wait: 0.101 s}]\n",
        "it touches the tray at the end",
        lambda run: run.signals.contact_forces["ball", "tray"][-1] > 0,
        (
            "placed: {object: ball, on: tray}",
            "in_contact: {between: [ball, tray], for: 20 ms}",
            "on: {object: ball, support: tray, for: 20 ms}",
        ),
        ("in_contact: {between: [ball, tray]}",),
    ),
    Scene(
        "lift that ends before the hold time",
        "the box is lifted by 6 cm and dropped after half a second",
        "objects:\n" + RED_BOX + "steps:" + AT_BOX + "  - move_relative: {direction: {xyz: "
        "[0, 0, 1]}, distance: 6 cm}\n  - wait: 0.5 s\n  - gripper: open\n  - wait: 1 s\n",
        "its highest point was 5 cm above its start",
        lambda run: rose(run, "red_box", 0.05),
        ("lifted: {object: red_box, above: 5 cm, for: 1 s}", "grasped: red_box"),
        ("lifted: {object: red_box, above: 5 cm}",),
    ),
    Scene(
        "object that spins in its place",
        "two boxes hit a bar at its ends from both sides, and it turns about its middle",
        "objects:\n"
        "  - {name: bar, box: {size: [0.3, 0.03, 0.03]}, mass: 100 g, friction: 0.005, "
        "pose: {xyz: [0.4, 0.4, 0.015]}}\n"
        "  - {name: left, box: {size: [0.03, 0.03, 0.03]}, mass: 100 g, friction: 0.005, "
        "pose: {xyz: [0.54, 0.36, 0.015]}}\n"
        "  - {name: right, box: {size: [0.03, 0.03, 0.03]}, mass: 100 g, friction: 0.005, "
        "pose: {xyz: [0.26, 0.44, 0.015]}}\n"
        "steps:\n  - inject: {push: {left: [0, 0.1, 0], right: [0, -0.1, 0]}}\n"
        "  - wait: 0.3 s\n",
        "it lies on the floor, and its origin moves slower than 5 cm/s",
        lambda run: speed_at_end(run, "bar") < 0.05,
        (
            "placed: {object: bar, max_velocity: 5 cm/s}",
            "static: {object: bar, max_velocity: 5 cm/s}",
        ),
        ("on: {object: bar, support: ground_plane}",),
    ),
    Scene(
        "object that stands on what the gripper holds",
        "a cube stands on the box that is lifted",
        "objects:\n" + RED_BOX + "  - {name: cube, box: {size: [0.03, 0.03, 0.02]}, mass: 10 g, "
        "friction: 1, in: simulation, pose: {xyz: [0.25, 0, 0.0915]}}\nsteps:"
        + AT_BOX
        + "  - move_relative: {direction: {xyz: [0, 0, 1]}, distance: 4 cm}\n  - wait: 0.3 s\n",
        "it touches something below it, nothing of the robot, and stands still",
        lambda run: not touched(run, "cube") and speed_at_end(run, "cube") < 0.005,
        ("placed: cube", "lifted: {object: cube, above: 2 cm}"),
        ("on: {object: cube, support: red_box}", "lifted: {object: red_box, above: 2 cm}"),
    ),
    Scene(
        "object put up bit by bit between the fingers",
        "steps move the box up by 4.5 mm seven times while the closed fingers touch it",
        "objects:\n"
        + RED_BOX
        + "steps:"
        + AT_BOX
        + "".join(
            f"  - move_object: {{object: red_box, pose: {{xyz: [0.25, 0, {z:.4f}]}}}}\n"
            "  - wait: 2 ms\n"
            for z in (0.0455, 0.05, 0.0545, 0.059, 0.0635, 0.068, 0.0725)
        ),
        "it rose by 2 cm, and both fingers touch it",
        lambda run: rose(run, "red_box", 0.02) and touched(run, "red_box"),
        (
            "lifted: {object: red_box, above: 2 cm}",
            "displaced: {object: red_box, at_least: 2 cm}",
            "grasped: red_box",
        ),
        ("in_contact: {between: [gripper, red_box]}",),
    ),
    Scene(
        "finger that opens against a wall",
        "the gripper opens next to a wall that is not in the planning scene",
        "objects:\n  - {name: wall, in: simulation, static: true, box: {size: [0.1, 0.02, 0.3]}, "
        "pose: {xyz: [0.29, 0.066, 0.15]}}\nsteps:\n  - gripper: close\n  - gripper: open\n",
        "the arm stood still, and the fingers may touch things while they move",
        lambda run: bool(np.ptp(run.signals.tcp_pose[:, :3], axis=0).max() < 0.005),
        ("never: collision",),
        ("gripper: {stalled: true}",),
    ),
    Scene(
        "box pinned against the wall of a bin",
        "the gripper presses the box against a side of the bin, 4 cm above its floor",
        "objects:\n  - name: bin\n    static: true\n    in: simulation\n"
        "    pose: {xyz: [0.35, 0, 0]}\n    shapes:\n"
        "      - {box: {size: [0.24, 0.2, 0.01]}, pose: {xyz: [0, 0, 0.005]}}\n"
        "      - {box: {size: [0.02, 0.2, 0.2]}, pose: {xyz: [0, 0, 0.1]}}\n"
        "  - {name: red_box, box: {size: [0.08, 0.04, 0.08]}, mass: 50 g, friction: 1, "
        "pose: {xyz: [0.27, 0, 0.051]}}\n"
        "steps:\n  - gripper: open\n  - move_to: {position: {xyz: [0.19, 0, 0.08]}, pitch: 0}\n"
        "  - lin: {position: {xyz: [0.25, 0, 0.08]}}\n  - grasp: red_box\n"
        "  - move_relative: {direction: {xyz: [0, 0, 1]}, distance: 4 cm}\n"
        "  - move_relative: {direction: {xyz: [1, 0, 0]}, distance: 3.1 cm}\n  - wait: 0.2 s\n",
        "the bin's floor is below it, and the bin touches it with more than its weight",
        lambda run: run.signals.contact_forces["bin", "red_box"][-1] > 0.5,
        ("on: {object: red_box, support: bin}", "placed: {object: red_box, on: bin}"),
        ("in_contact: {between: [red_box, bin]}",),
    ),
    Scene(
        "camera that looks the other way",
        "the box stands where the camera could see it, behind its back",
        "cameras:\n  - {name: eye, pose: {xyz: [0.6, 0, 0.3]}, look_at: [-0.2, 0, 0.3], "
        "image: {width: 160, height: 120}}\n"
        "objects:\n  - {name: red_box, static: true, color: [1, 0, 0, 1], "
        "box: {size: [0.08, 0.08, 0.08]}, pose: {xyz: [1.2, 0, 0.3]}}\n"
        "steps:\n  - wait: 0.1 s\n",
        "it is nearer to the camera than 1 m",
        lambda run: bool(np.linalg.norm(place_of(run, "red_box")[-1] - (0.6, 0, 0.3)) < 1),
        ("sees: {camera: eye, object: red_box, min_visible: 0.01, min_area: 1}",),
        ("never: {sees: {camera: eye, object: red_box, min_visible: 0.01, min_area: 1}}",),
    ),
)
