"""Tricks: what holds, carries, moves or turns is not what it seems to be."""

from __future__ import annotations

import numpy as np

from harness.recording.run import Run
from tests.adversarial.contact_scenes import (
    GRASP,
    UP,
    acceleration,
    in_tcp_moved,
    mass_of,
    robot_never_touches,
    touches,
)
from tests.adversarial.scenes import RED_BOX, Scene, near, place_of, rose, speed_at_end, touched
from tests.adversarial.window_scenes import CUBE, PUSH


def _link(name: str, mass: float, size: str, xyz: str) -> str:
    return (
        f'<link name="{name}"><inertial><mass value="{mass}"/>'
        '<inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial><collision>'
        f'<origin xyz="{xyz}"/><geometry><box size="{size}"/></geometry></collision></link>'
    )


def _slider(name: str, parent: str, child: str, axis: str, upper: float, more: str = "") -> str:
    return (
        f'<joint name="{name}" type="prismatic"><parent link="{parent}"/><child link="{child}"/>'
        f'<axis xyz="{axis}"/><limit lower="0" upper="{upper}" velocity="1" effort="200"/>{more}'
        "</joint>"
    )


URDF = (
    '<robot name="clamp"><link name="rail"/>'
    + _link("cart", 2, "0.02 0.01 0.1", "0 0.05 0")
    + _link("jaw", 1, "0.02 0.01 0.1", "0 -0.05 0")
    + _link("palm", 0.3, "0.06 0.12 0.02", "0.3 0 0")
    + _link("finger_left", 0.1, "0.02 0.01 0.06", "0.3 0.005 -0.04")
    + _link("finger_right", 0.1, "0.02 0.01 0.06", "0.3 -0.005 -0.04")
    + '<link name="tcp"/>'
    + _slider("lift", "rail", "cart", "0 0 1", 0.8)
    + _slider("clamp", "cart", "jaw", "0 1 0", 0.06)
    + '<joint name="mount" type="fixed"><parent link="jaw"/><child link="palm"/></joint>'
    + _slider("left", "palm", "finger_left", "0 1 0", 0.04)
    + _slider("right", "palm", "finger_right", "0 -1 0", 0.04, '<mimic joint="left"/>')
    + '<joint name="tool" type="fixed"><parent link="palm"/><child link="tcp"/>'
    '<origin xyz="0.3 0 -0.05"/></joint></robot>'
)
HAND = ("palm", "finger_left", "finger_right")
NEIGHBOURS = [(first, second) for first in HAND for second in (*HAND, "jaw") if first < second]
NEIGHBOURS += [("jaw", "palm"), ("cart", "jaw"), ("cart", "palm")]
SRDF = (
    '<robot name="clamp"><group name="arm"><chain base_link="rail" tip_link="tcp"/></group>'
    '<group name="gripper"><joint name="left"/><joint name="right"/></group>'
    '<group_state name="ready" group="arm"><joint name="lift" value="0.2"/>'
    '<joint name="clamp" value="0"/></group_state>'
    '<group_state name="open" group="gripper"><joint name="left" value="0.04"/></group_state>'
    '<group_state name="close" group="gripper"><joint name="left" value="0"/></group_state>'
    '<end_effector name="hand" parent_link="tcp" group="gripper" parent_group="arm"/>'
    '<passive_joint name="right"/>'
    + "".join(
        f'<disable_collisions link1="{first}" link2="{second}" reason="Adjacent"/>'
        for first, second in NEIGHBOURS
    )
    + "</robot>"
)
CLAMP = "{urdf: clamp.urdf, srdf: clamp.srdf, gripper: hand, start_state: {named_target: ready}}"
CLAMP_FILES = {"clamp.urdf": URDF, "clamp.srdf": SRDF}
RUG = "  - {name: rug, in: simulation, static: true, box: {size: [0.3, 0.4, 0.003]}, pose: {xyz: [0.25, 0, 0]}}\n"  # noqa: E501
REGRIP = "  - gripper: open\n  - detach_object: {object: red_box}\n  - grasp: red_box\n"
TABLE = (
    "  - {name: table, static: true, box: {size: [0.2, 0.2, 0.1]}, pose: {xyz: [0.3, 0.2, 0.05]}}\n"
)
TRAY = (
    "  - {name: tray, static: true, box: {size: [0.2, 0.2, 0.02]}, pose: {xyz: [0.3, 0.3, 0.01]}}\n"
)
CAN = "  - {name: can, cylinder: {radius: 0.02, length: 0.06}, mass: 50 g, pose: {xyz: [0.3, 0.24, 0.0399], rpy: [0, 1.5707963, 0]}}\n"  # noqa: E501
ROD = "  - {name: rod, box: {size: [0.02, 0.02, 0.2]}, mass: 50 g, pose: {xyz: [0.3, 0.2, 0.1004], rpy: [0.15, 0, 0]}%s}\n"  # noqa: E501


def dragged(*places: float) -> str:
    """The hand goes to places along y, and grips anew at each."""
    return "".join(f"  - lin: {{position: {{xyz: [0.25, {y}, 0.06]}}}}\n{REGRIP}" for y in places)


def on_rug(run: Run) -> bool:
    """The box touches the rug at every sample at which it is displaced by less than 6 cm."""
    return bool((touches(run, "red_box", "rug") > 0).mean() > 0.5)


def raised_by(run: Run, name: str, other: str) -> bool:
    """While an object rises another one presses it from below."""
    rising = np.gradient(place_of(run, name)[:, 2]) / run.timestep > 0.02
    return bool((touches(run, name, other)[rising] > 0).mean() > 0.5)


TRICK_SCENES = (
    Scene(
        "box pinched between links of the arm",
        "two plates of the arm, not its fingers, squeeze a box and lift it; the file allows their"
        " contact",
        "objects:\n  - {name: box, box: {size: [0.04, 0.04, 0.08]}, mass: 50 g, friction: 1, "
        "pose: {xyz: [0, 0.01, 0.0401]}}\nsteps:\n  - allow_collisions:\n"
        "      pairs: [[jaw, box], [cart, box]]\n      during:\n        - gripper: open\n"
        "        - ptp: {joints: {lift: 0.08, clamp: 0}}\n"
        "        - ptp: {joints: {lift: 0.08, clamp: 0.0505}}\n"
        "        - ptp: {joints: {lift: 0.18, clamp: 0.0505}}\n        - gripper: close\n",
        "the robot presses it from both sides, nothing else touches it, and it rose by 5 cm",
        lambda run: rose(run, "box", 0.05) and touched(run, "box"),
        ("lifted: {object: box, above: 1 cm}", "grasped: box",
         "never: {collision: {count_allowed: true}}"),
        ("never: collision", "displaced: {object: box, at_least: 5 cm}"),
        truth=lambda run: not any(
            touches(run, "box", finger).max() > 0 for finger in HAND
        ),
        robot=CLAMP,
        files=CLAMP_FILES,
    ),
    Scene(
        "box raised between the fingers by a block below it",
        "the fingers touch the box lightly and stand still, while a block below it is pushed up",
        "objects:\n" + RED_BOX.replace("0.041", "0.091") + "  - {name: block, box: "
        "{size: [0.03, 0.03, 0.05]}, mass: 100 g, friction: 0.1, pose: {xyz: [0.25, 0, 0.0251]}}\n"
        "steps:\n  - gripper: open\n  - move_to: {position: {xyz: [0.19, 0, 0.11]}, pitch: 0}\n"
        "  - lin: {position: {xyz: [0.25, 0, 0.11]}}\n"
        "  - gripper: {position: -0.01, max_effort: 0.2}\n"
        "  - inject: {push: {block: [0, 0, 2.8]}, push_duration: 0.1}\n",
        "it rose by 1 cm, and both fingers touch it",
        lambda run: rose(run, "red_box", 0.01) and touched(run, "red_box"),
        ("lifted: {object: red_box, above: 5 mm}",
         "lifted: {object: red_box, above: 5 mm, cradled: true}"),
        ("displaced: {object: red_box, at_least: 5 mm}",),
        truth=lambda run: raised_by(run, "red_box", "block"),
    ),
    Scene(
        "box dragged bit by bit",
        "the gripper drags the box 6 cm along a rug, and lets go and grips again after each 1.6 cm",
        "objects:\n" + RED_BOX.replace("0.041", "0.0417") + RUG
        + "steps:" + GRASP + dragged(0.016, 0.032, 0.048, 0.064) + "  - release: red_box\n",
        "in no grip the box is moved by 2 cm, and the robot never touches the rug",
        lambda run: robot_never_touches(run, "rug"),
        ("never: collision", "never: {collision: {between: [red_box, rug]}}"),
        ("displaced: {object: red_box, at_least: 6 cm}",
         "never: {collision: {between: [robot, rug]}}"),
        truth=on_rug,
    ),
    Scene(
        "box gripped twice where it stands",
        "the gripper lets go, grips again without moving, and lifts the box",
        "objects:\n" + RED_BOX.replace("0.041", "0.0417") + RUG
        + "steps:" + GRASP + REGRIP + UP + "  - wait: 0.2 s\n",
        "it was gripped and let go without leaving the rug: too strict",
        lambda run: touched(run, "red_box"),
        (),
        ("never: collision", "lifted: {object: red_box, above: 5 cm}", "grasped: red_box"),
        truth=lambda run: in_tcp_moved(run, "red_box", slice(-1000, None)) < 0.002,
    ),
    Scene(
        "can that rolls through the tray",
        "when the step ends a can is in the middle of the tray, and rolls on and off",
        "objects:\n" + TRAY + CAN + "steps:\n" + PUSH % ("can", "0, 20, 0")
        + "  - {wait: 0.2 s, id: roll}\n  - wait: 1 s\n",
        "at the end of the step it is above the tray and less than 6 cm from its middle",
        lambda run: bool(abs(place_of(run, "can")[200, 1] - 0.3) < 0.06),
        ("{placed: {object: can, on: tray}, during: roll}",
         "{static: can, during: roll}",
         "on: {object: can, support: tray}"),
        ("{on: {object: can, support: tray}, during: roll}",),
        truth=lambda run: bool(place_of(run, "can")[-1, 1] > 0.4),
    ),
    Scene(
        "can that stays in the tray",
        "a slow push rolls the can by less than 1 mm",
        "objects:\n" + TRAY + CAN + "steps:\n" + PUSH % ("can", "0, 0.05, 0")
        + "  - {wait: 0.3 s, id: roll}\n",
        "a can can roll, and is pushed: too strict",
        lambda run: near(run, "can", "tray", (0.1, 0.1, 0.06)),
        (),
        ("{on: {object: can, support: tray, for: 0.2 s}, during: roll}",
         "static: can"),
        truth=lambda run: speed_at_end(run, "can") < 0.002,
    ),
    Scene(
        "fixture that rises with the box on it",
        "steps move the table up by 2 cm, half a millimetre at a time; the box rides on it",
        "objects:\n" + TABLE + CUBE % "0.3, 0.2, 0.12" + "steps:\n  - wait: 0.1 s\n"
        + "".join(
            "  - move_object: {object: table, pose: {xyz: [0.3, 0.2, %.4f]}}\n  - wait: 50 ms\n"
            % (0.05 + 0.0005 * k) for k in range(1, 41)
        ) + "  - wait: 1 s\n",
        "it rose by 1 cm, is released, and stands on the table",
        lambda run: rose(run, "cube", 0.01) and not touched(run, "cube"),
        ("lifted: {object: cube, above: 1 cm}",),
        ("on: {object: cube, support: table}", "displaced: {object: cube, at_least: 1 cm}"),
        warned=("placed: {object: cube, on: table}",
                "placed: {object: cube, pose: {xyz: [0, 0, 0.07], frame: table}}"),
        truth=lambda run: robot_never_touches(run, "cube"),
    ),
    Scene(
        "rod that seems to rest",
        "a rod of 50 g leans by 8.6 degrees and has the inertia of a lorry: it falls too slowly to"
        " be seen",
        "objects:\n" + ROD % ", inertia: {ixx: 100, iyy: 100, izz: 100}"
        + "steps: [{wait: 0.5 s}]\n",
        "it stands on the floor and moves slower than 5 mm/s",
        lambda run: speed_at_end(run, "rod") < 0.005,
        ("upright: {object: rod, tolerance: 5 deg}",
         "placed: {object: rod, pose: {xyz: [0.3, 0.2, 0.1]}}"),
        ("static: rod",),
        truth=lambda run: any("seems to rest" in each.message for each in run.findings),
    ),
    Scene(
        "rod that falls",
        "the same rod with the inertia of its shape",
        "objects:\n" + ROD % "" + "steps: [{wait: 0.2 s}]\n",
        "it touches the floor and stands no further than 2 cm from where it stood",
        lambda run: bool(np.ptp(place_of(run, "rod")[:, 0]) < 0.02),
        ("static: rod", "placed: rod", "upright: rod"),
        truth=lambda run: not any("seems to rest" in each.message for each in run.findings),
    ),
    Scene(
        "box left in the air without gravity",
        "without gravity the hand lifts a box, lets go, and leaves it where it is",
        "objects:\n" + RED_BOX.replace("0.041", "0.0601") + "steps:" + GRASP + UP
        + "  - release: red_box\n  - lin: {position: {xyz: [0.19, 0, 0.12]}}\n  - wait: 0.2 s\n",
        "it stays 5 cm above its start",
        lambda run: rose(run, "red_box", 0.05) and speed_at_end(run, "red_box") < 0.005,
        ("placed: red_box", "grasped: red_box",
         "lifted: {object: red_box, above: 3 cm, for: 2 s}"),
        ("lifted: {object: red_box, above: 3 cm}", "static: red_box", "released: red_box"),
        "weightless",
        truth=lambda run: not touched(run, "red_box"),
    ),
    Scene(
        "cube nudged up without gravity",
        "the closed hand rises and pushes a weightless cube, which flies on",
        "objects:\n" + CUBE % "0.286, 0, 0.27" + "steps:\n  - gripper: close\n"
        "  - allow_collisions:\n      pairs: [[gripper_left_link, cube], "
        "[gripper_right_link, cube], [link5, cube]]\n      during:\n"
        "        - move_relative: {direction: {xyz: [0, 0, 1]}, distance: 5 cm}\n"
        "  - wait: 0.5 s\n",
        "the gripper alone touches it, and it rose by 2 cm",
        lambda run: rose(run, "cube", 0.02) and touched(run, "cube", at_end=False),
        ("lifted: {object: cube, above: 1 cm}", "grasped: cube", "placed: cube",
         "lifted: {object: cube, above: 1 cm, cradled: true}"),
        ("displaced: {object: cube, at_least: 2 cm}",),
        "weightless",
        truth=lambda run: bool(
            mass_of(run, "cube") * np.abs(acceleration(run, "cube")[-100:]).max() < 0.01
        ),
    ),
)  # fmt: skip
