"""Scenes in which little was observed: vacuous verdicts, cut windows, gaps between samples."""

from __future__ import annotations

import numpy as np

from tests.adversarial.scenes import AT_BOX, RED_BOX, Scene, place_of, rose, speed_at_end, touched

CUBE = "  - {name: cube, box: {size: [0.04, 0.04, 0.04]}, mass: 50 g, pose: {xyz: [%s]}}\n"
ON_FLOOR = "0.3, 0.2, 0.0199"
GHOST = "  - {name: ghost, in: planning, box: {size: [0.04, 0.04, 0.04]}, pose: {xyz: [0.3, 0.2, 0.02]}}\n"  # noqa: E501
LATE = "  - add_object: {name: late, box: {size: [0.04, 0.04, 0.04]}, pose: {xyz: [0.3, -0.2, 0.02]}}\n"  # noqa: E501
LIFT = "  - move_relative: {direction: {xyz: [0, 0, 1]}, distance: 5 cm}\n"
BALL = "  - {name: ball, sphere: {radius: 0.005}, mass: 1 g, in: simulation, pose: {xyz: [%s]}}\n"
PUSH = "  - inject: {push: {%s: [%s]}, push_duration: 1 ms}\n"
PLATE = "  - {name: plate, static: true, in: simulation, box: {size: [0.004, 0.2, 0.2]}, pose: {xyz: [0.6, 0.3, 0.3]}}\n"  # noqa: E501


def speed_of(run, name, time):
    """Speed of an object at a time [m/s]."""
    sample = int(np.searchsorted(run.signals.times, time))
    step = place_of(run, name)[sample] - place_of(run, name)[sample - 1]
    return float(np.linalg.norm(step) / run.timestep)


def farther_from_tcp(run, name, distance):
    """Whether an object's origin is at every sample further than this from the TCP [m]."""
    apart = place_of(run, name) - run.signals.tcp_pose[:, :3]
    return bool((np.linalg.norm(apart, axis=1) > distance).all())


def shot(speed, *, x=0.316, z=0.2168):
    """A ball of 1 g that flies past the gripper along y, in 15 cm to the middle of two samples."""
    reach = speed * 1e-3
    start = reach * (max(3, round(0.15 / reach)) + 0.5)
    wait = max(0.01, 2 * start / speed)
    return (
        "objects:\n" + BALL % f"{x}, {-start:.6f}, {z}"
        + "steps:\n" + PUSH % ("ball", f"0, {speed:g}, 0") + f"  - wait: {wait:.3f} s\n"
    )  # fmt: skip


REMOVED = CUBE % ON_FLOOR + "steps:\n  - wait: 0.2 s\n  - remove_object: cube\n"
PLANK = "  - {name: plank, box: {size: [4, 0.1, 0.02]}, mass: 2 kg, friction: 0.002, pose: {xyz: [0, 3, 0.0101]}}\n"  # noqa: E501
BUMPER = "  - {name: %s, box: {size: [0.04, 0.04, 0.04]}, mass: 1 kg, friction: 0.002, pose: {xyz: [%s, 0.0201]}}\n"  # noqa: E501
BUMPERS = BUMPER % ("front", "1.95, 3.075") + BUMPER % ("back", "-1.95, 2.925")
TURN = "  - inject: {push: {front: [0, -1, 0], back: [0, 1, 0]}, push_duration: 0.1}\n"


def ends_move(run, name, speed, half=2.0):
    """Whether an end of a plank, this far from its origin along x, is faster than this [m/s]."""
    quat = run.signals.object_poses[name][:, 3:]
    yaw = 2 * np.arctan2(quat[:, 3], quat[:, 0])
    end = place_of(run, name)[:, :2] + half * np.column_stack([np.cos(yaw), np.sin(yaw)])
    return bool((np.linalg.norm(np.diff(end, axis=0), axis=1) / run.timestep > speed).any())


WINDOW_SCENES = (
    Scene(
        "box that a step removes before the end",
        "a step removes a box, and the run goes on for 0.2 s",
        "objects:\n" + REMOVED + "  - {wait: 0.2 s, id: after}\n",
        "no contact with the robot was recorded in the last step",
        lambda run: not touched(run, "cube"),
        ("released: cube", "upright: cube", "static: cube", "placed: cube",
         "{always: {upright: cube}, during: after}",
         "{never: {in_contact: {between: [robot, cube]}}, during: after}",
         "{never: {collision: {between: [robot, cube]}}, during: after}"),
        ("always: {upright: cube}", "never: {in_contact: {between: [robot, cube]}}"),
    ),
    Scene(
        "pillar that a step removes before the arm moves",
        "a step removes the pillar next to the arm, which then moves",
        "objects:\n  - {name: pillar, static: true, box: {size: [0.05, 0.05, 0.2]}, "
        "pose: {xyz: [0.3, 0.3, 0.1]}}\n"
        "steps:\n  - remove_object: pillar\n"
        "  - {move_relative: {direction: {xyz: [0, 0, 1]}, distance: 5 cm}, id: go}\n",
        "no distance below 1 cm was recorded while the arm moved",
        lambda run: not (run.signals.clearances["robot", "pillar"] < 0.01).any(),
        ("{clearance: {between: [robot, pillar], at_least: 1 cm}, during: go}",
         "{never: {collision: {between: [robot, pillar]}}, during: go}"),
        ("{never: {collision: {between: [robot, ground_plane]}}, during: go}",),
    ),
    Scene(
        "box that a step removes after it was judged",
        "a box is judged over the step before the one that removes it",
        "objects:\n" + REMOVED.replace("wait: 0.2 s", "{wait: 0.2 s, id: before}"),
        "the box is not there when the run ends: too strict",
        lambda run: bool(np.isnan(place_of(run, "cube")[-1]).any() or len(run.steps) == 2),
        (),
        ("{upright: cube, during: before}", "{static: cube, during: before}",
         "{always: {upright: cube}, during: before}",
         "{never: {in_contact: {between: [robot, cube]}}, during: before}"),
    ),
    Scene(
        "plank of 4 m that turns slowly",
        "two boxes hit its ends from both sides: it turns at 2 degrees a second, and its ends move"
        " at 7 cm/s",
        "objects:\n" + PLANK + BUMPERS + "steps:\n" + TURN + "  - wait: 0.2 s\n",
        "its origin moves slower than 5 mm/s, and it turns slower than 0.05 rad/s",
        lambda run: speed_at_end(run, "plank") < 0.005,
        ("static: plank", "placed: plank"),
        ("on: {object: plank, support: ground_plane}",),
        truth=lambda run: ends_move(run, "plank", 0.04),
    ),
    Scene(
        "plank of 4 m that lies still",
        "the same plank after it has settled",
        "objects:\n" + PLANK + "steps: [{wait: 0.5 s}]\n",
        "its ends are 2 m away from its middle: too strict",
        lambda run: speed_at_end(run, "plank") < 0.01,
        (),
        ("static: plank", "on: {object: plank, support: ground_plane}"),
        truth=lambda run: speed_at_end(run, "plank") < 1e-4,
    ),
    Scene(
        "object that only the planner knows",
        "the arm's planner avoids a box that is not in the physics",
        "objects:\n" + GHOST + CUBE % "0.3, -0.2, 0.0199" + "steps: [{wait: 0.2 s}]\n",
        "no contact with it was recorded",
        lambda run: not touched(run, "ghost", at_end=False),
        (
            "never: {in_contact: {between: [ghost, robot]}}",
            "never: {collision: {between: [ghost, robot]}}",
            "formula: always force(robot, ghost) < 1 N",
        ),
        ("never: {in_contact: {between: [cube, robot]}}",),
    ),
    Scene(
        "object that comes after the step it is judged over",
        "a step adds a box; no contact with it is expected of the step before",
        "objects: []\nsteps:\n  - {wait: 0.2 s, id: early}\n  - wait: 10 ms\n" + LATE
        + "  - {wait: 0.2 s, id: later}\n",
        "no contact with it was recorded in that step",
        lambda run: not touched(run, "late", at_end=False),
        (
            "{never: {in_contact: {between: [late, robot]}}, during: early}",
            "{never: {collision: {between: [late, robot]}}, during: early}",
            "{clearance: {between: [robot, late], at_least: 1 cm}, during: early}",
            '{formula: "always force(robot, late) < 1 N", during: early}',
        ),
        (
            "{never: {in_contact: {between: [late, robot]}}, during: later}",
            "never: {in_contact: {between: [late, robot]}}",
        ),
    ),
    Scene(
        "premise that never holds",
        "the box is not lifted, and it must be held while it is above 10 cm",
        "objects:\n" + CUBE % ON_FLOOR + "steps: [{wait: 0.2 s}]\n",
        "no sample shows it above 10 cm and not held",
        lambda run: not rose(run, "cube", 0.1),
        (),
        ("formula: always (z(cube) > 1 cm implies tilt(cube) < 5 deg)",),
        warned=(
            "formula: always (z(cube) > 10 cm implies force(gripper, cube) > 0.1 N)",
            "formula: always (not z(cube) > 10 cm or force(gripper, cube) > 0.1 N)",
        ),
    ),
    Scene(
        "until that comes at its first sample",
        "a sliding box must stand still until it is upright, and upright it is from the first"
        " sample on",
        "objects:\n" + CUBE % ON_FLOOR
        + "steps:\n" + PUSH % ("cube", "20, 0, 0")
        + "  - wait: 0.3 s\n",
        "it was upright, and at no sample before that it moved",
        lambda run: rose(run, "cube", -1),
        (),
        ("{always: {upright: cube}, until: {displaced: {object: cube, at_least: 5 mm}}}",),
        warned=("{always: {static: cube}, until: {upright: cube}}",),
    ),
    Scene(
        "lift before the step that it is expected of",
        "the box is lifted, and the step after that expects it to be lifted",
        "objects:\n" + RED_BOX + "steps:" + AT_BOX + LIFT + "  - {wait: 0.3 s, id: hold}\n",
        "during the step it is 3 cm above its start and in the hand",
        lambda run: rose(run, "red_box", 0.03) and touched(run, "red_box"),
        (),
        ("lifted: {object: red_box, above: 3 cm}", "{always: {grasped: red_box}, during: hold}"),
        warned=(
            "{lifted: {object: red_box, above: 3 cm}, during: hold}",
            "{eventually: {lifted: {object: red_box, above: 3 cm}}, during: hold}",
            "{displaced: {object: red_box, at_least: 3 cm}, during: hold}",
        ),
    ),
    Scene(
        "object that stands where it stood",
        "nothing moves, and the box rests on the floor at the place where it was to be put",
        "objects:\n" + CUBE % ON_FLOOR + "steps: [{wait: 0.3 s}]\n",
        "it rests near the goal, and the gripper does not touch it",
        lambda run: speed_at_end(run, "cube") < 0.005 and not touched(run, "cube"),
        (),
        ("on: {object: cube, support: ground_plane}", "upright: cube"),
        warned=(
            "placed: {object: cube, pose: {xyz: [0.3, 0.2, 0.02]}}",
            "released: cube",
            "eventually: {upright: cube}",
        ),
    ),
    Scene(
        "object that a push put there",
        "the box slides 5 cm and comes to rest: what holds now did not hold at the start",
        "objects:\n" + CUBE % ON_FLOOR
        + "steps:\n" + PUSH % ("cube", "50, 0, 0")
        + "  - wait: 0.6 s\n",
        "it rests, and is not where it was",
        lambda run: speed_at_end(run, "cube") < 0.005,
        (),
        (
            "placed: cube",
            "displaced: {object: cube, at_least: 1 cm}",
            "eventually: {displaced: {object: cube, at_least: 1 cm}}",
        ),
    ),
    Scene(
        "turning point of a throw",
        "a step of 4 ms begins 1 ms before the top of a throw, where the box hardly moves",
        "objects:\n" + CUBE % ON_FLOOR
        + "steps:\n" + PUSH % ("cube", "0, 0, 50")
        + "  - wait: 0.101 s\n"
        "  - {wait: 4 ms, id: top}\n  - wait: 0.5 s\n",
        "at the end of the step it is slower than 5 cm/s",
        lambda run: speed_of(run, "cube", 0.105) < 0.05,
        (
            "{static: {object: cube, max_velocity: 5 cm/s}, during: top}",
            "{always: {static: {object: cube, max_velocity: 5 cm/s}}, during: top}",
        ),
        ("static: cube",),
    ),
    Scene(
        "let go in the air",
        "a box begins to fall 50 cm above the floor; after 10 ms it is still slow",
        "objects:\n" + CUBE % "0.3, 0.2, 0.5" + "steps:\n  - {wait: 10 ms, id: first}\n"
        "  - wait: 0.8 s\n",
        "it is slower than 10 cm/s when the step ends",
        lambda run: speed_of(run, "cube", 0.01) < 0.1,
        ("{static: {object: cube, max_velocity: 10 cm/s}, during: first}",),
        ("static: cube",),
    ),
    Scene(
        "box that stands still during a step of 2 ms",
        "what the step itself is too short to show was recorded before it",
        "objects:\n" + CUBE % ON_FLOOR + "steps:\n  - wait: 0.2 s\n  - {wait: 2 ms, id: short}\n",
        "it is slower than 5 mm/s when the step ends",
        lambda run: speed_at_end(run, "cube") < 0.005,
        (),
        (
            "{static: cube, during: short}",
            "{always: {static: cube}, during: short}",
            "{always: {static: {}}, during: short}",
        ),
    ),
    Scene(
        "step that takes no time",
        "a step puts the box elsewhere; another is expected to fail before anything moves",
        "objects:\n" + CUBE % ON_FLOOR
        + "steps:\n  - wait: 0.1 s\n"
        "  - {move_object: {object: cube, pose: {xyz: [0.3, 0.25, 0.0199]}}, id: put}\n"
        "  - {move_to: {position: {xyz: [3, 0, 0.2]}}, expect_error: NO_IK_SOLUTION, id: fails}\n"
        "  - {wait: 3 ms, id: short}\n",
        "at no sample of the step anything touches the robot",
        lambda run: not touched(run, "cube", at_end=False),
        (),
        (
            "{never: {in_contact: {between: [robot, cube]}}, during: short}",
            "{upright: cube, during: put}",
        ),
        warned=(
            "{never: {in_contact: {between: [robot, cube]}}, during: put}",
            "{never: collision, during: fails}",
            "{always: {upright: cube}, during: fails}",
        ),
    ),
    Scene(
        "ball that passes the gripper between two samples",
        "a ball at 30 m/s moves by 3 cm from sample to sample, and flies past the fingers",
        shot(30.0),
        "its middle is further than 3.2 cm from the TCP at every sample",
        lambda run: farther_from_tcp(run, "ball", 0.032),
        ("clearance: {between: [robot, ball], at_least: 1 cm}",),
        ("clearance: {between: [robot, ball], at_least: 2 mm}",),
        "weightless",
    ),
    Scene(
        "ball that passes the gripper at 100 m/s",
        "from sample to sample it moves by 10 cm",
        shot(100.0),
        "its middle is further than 5 cm from the TCP at every sample",
        lambda run: farther_from_tcp(run, "ball", 0.05),
        ("clearance: {between: [robot, ball], at_least: 1 cm}",),
        ("clearance: {between: [robot, ball], at_least: 2 mm}",),
        "weightless",
    ),
    Scene(
        "slow ball that passes the gripper at a distance",
        "at 1 m/s every sample is near the next: the distance is what it is",
        shot(1.0, x=0.356),
        "its middle is further than 6 cm from the TCP at every sample",
        lambda run: farther_from_tcp(run, "ball", 0.06),
        (),
        ("clearance: {between: [robot, ball], at_least: 4 cm}",),
        "weightless",
    ),
    Scene(
        "ball that passes through a plate between two samples",
        "at 60 m/s a ball of 1 cm is before a plate of 4 mm at one sample, and past it at the"
        " next",
        "objects:\n" + PLATE + BALL % "0.8, 0.3, 0.3"
        + "steps:\n" + PUSH % ("ball", "-60, 0, 0")
        + "  - wait: 10 ms\n",
        "no contact of the two was recorded",
        lambda run: ("ball", "plate") not in run.signals.contact_forces,
        (),
        ("never: {in_contact: {between: [plate, robot]}}",),
        "weightless",
        warned=(
            "never: {in_contact: {between: [ball, plate]}}",
            "never: {collision: {between: [ball, any]}}",
        ),
    ),
    Scene(
        "ball at 200 m/s through a cube",
        "it moves by 20 cm from sample to sample, and the cube is 4 cm wide",
        "objects:\n" + CUBE % "0.5, 0.3, 0.3" + BALL % "0.8, 0.3, 0.3"
        + "steps:\n" + PUSH % ("ball", "-200, 0, 0")
        + "  - wait: 5 ms\n",
        "no contact of the two was recorded",
        lambda run: ("ball", "cube") not in run.signals.contact_forces,
        (),
        ("never: {in_contact: {between: [cube, robot]}}",),
        "weightless",
        warned=("never: {in_contact: {between: [ball, cube]}}",),
    ),
    Scene(
        "ball that misses the plate at 5 m/s",
        "from sample to sample it moves by half its width: no contact can be missed",
        "objects:\n" + PLATE + BALL % "0.8, 0.3, 0.5"
        + "steps:\n" + PUSH % ("ball", "-5, 0, 0")
        + "  - wait: 80 ms\n",
        "no contact of the two was recorded",
        lambda run: ("ball", "plate") not in run.signals.contact_forces,
        (),
        ("never: {in_contact: {between: [ball, plate]}}",),
        "weightless",
    ),
)  # fmt: skip
