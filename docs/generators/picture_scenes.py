"""The short scenarios that pictures of expectations are drawn from, and those expectations."""

from tests.judging.evidence import pictures

HEAD = """
scenario: {title}
robot: {{model: open_manipulator_x, base: {{xyz: [0, 0, 0.01]}}}}
world: empty
"""
BOX = """
objects:
  - {name: red_box, box: {size: [0.04, 0.04, 0.08]}, pose: {xyz: [0.25, 0, 0.041]},
     mass: 50 g, friction: %s}
  - {name: post, static: true, box: {size: [0.03, 0.03, 0.3]}, pose: {xyz: [0.25, 0.14, 0.15]}}
steps:
  - gripper: open
  - move_to: {position: {xyz: [0.19, 0, 0.06]}, pitch: 0}
    id: approach
  - lin: {position: {xyz: [0.25, 0, 0.06]}}
    id: reach
  - grasp: red_box
    id: close
  - move_relative: {direction: {xyz: [0, 0, 1]}, distance: 8 cm}
    id: lift
"""
CUP = """
objects:
  - name: cup
    mass: 200 g
    pose: {xyz: [0.3, 0.2, 0.052], rpy: [0, %s, 0]}
    shapes:
      - {box: {size: [0.09, 0.09, 0.005]}, pose: {xyz: [0, 0, -0.05]}}
      - {box: {size: [0.005, 0.09, 0.1]}, pose: {xyz: [0.0425, 0, 0]}}
      - {box: {size: [0.005, 0.09, 0.1]}, pose: {xyz: [-0.0425, 0, 0]}}
      - {box: {size: [0.09, 0.005, 0.1]}, pose: {xyz: [0, 0.0425, 0]}}
      - {box: {size: [0.09, 0.005, 0.1]}, pose: {xyz: [0, -0.0425, 0]}}
  - {name: ball, sphere: {radius: 0.015}, mass: 20 g, pose: {xyz: [0.3, 0.2, 0.16]}}
steps:
  - wait: 0.8 s
"""
EYE = """
cameras:
  - {name: eye, pose: {xyz: [0.7, 0, 0.25]}, look_at: [0.2, 0, 0.1],
     image: {width: 160, height: 120}}
objects:
  - {name: red_box, box: {size: [0.06, 0.06, 0.06]}, pose: {xyz: [0.3, %s, 0.031]},
     color: [1, 0, 0, 1]}
  - {name: wall, static: true, box: {size: [0.01, 0.1, 0.12]}, pose: {xyz: [0.4, -0.12, 0.06]},
     color: [0.3, 0.4, 0.9, 1]}
steps:
  - wait: 0.1 s
  - capture: {camera: eye, kinds: [color, segmentation]}
"""
SCENES = {
    "pick": BOX % 1
    + """
  - wait: 0.4 s
    id: hold
  - place: {object: red_box, pose: {xyz: [0.25, 0, 0.041]}}
  - wait: 0.3 s
""",
    "slippery": BOX % 1
    + """
  - inject: {friction: {red_box: 0.08}, gripper_effort: 0.06}
  - wait: 1.2 s
    id: hold
""",
    "wall": """
objects:
  - {name: wall, in: simulation, static: true, box: {size: [0.3, 0.03, 0.3]},
     pose: {xyz: [0.2, 0.16, 0.15]}}
steps:
  - move_to: {position: {xyz: [0.2, 0, 0.1]}, pitch: 0}
  - ptp: {joints: {joint1: 60 deg}}
    id: swing
    expect_error: CONTROL_FAILED
""",
    "slab": """
objects:
  - {name: slab, box: {size: [0.02, 0.1, 0.3]}, mass: 100 g,
     pose: {xyz: [0.42, 0, 0.152], rpy: [0, -0.12, 0]}}
steps:
  - gripper: close
  - move_to: {position: {xyz: [0.27, 0, 0.15]}, pitch: 0}
  - wait: 0.8 s
""",
    "cup": CUP % "0",
    "tipping cup": CUP % "0.6"
    + """
  - inject: {push: {cup: [3, 0, 0]}, push_duration: 200 ms}
  - wait: 0.6 s
""",
    "late": """
steps:
  - inject: {command_latency: 60 ms}
  - ptp: {joints: {joint1: 40 deg}}
    id: swing
""",
    "paths": """
steps:
  - move_to: {position: {xyz: [0.2, -0.08, 0.1]}, pitch: 0}
  - lin: {position: {xyz: [0.2, 0.08, 0.1]}}
    id: straight
  - ptp: {position: {xyz: [0.2, -0.08, 0.1]}, pitch: 0}
    id: bent
  - cartesian_path: {waypoints: [{xyz: [0.2, 0, 0.1]}, {xyz: [0.2, 0.08, 0.1]}]}
    id: whole
  - cartesian_path: {waypoints: [{xyz: [0.6, 0.08, 0.1]}], min_fraction: 0.1}
    id: beyond
""",
    "stalled": """
steps:
  - inject: {joint_stall: joint1}
  - ptp: {joints: {joint1: 40 deg}}
    id: swing
    expect_error: CONTROL_FAILED
""",
    "hammer": """
objects:
  - {name: hammer, box: {size: [0.06, 0.06, 0.06]}, mass: 3 kg, pose: {xyz: [0.25, 0, 0.6]}}
steps:
  - wait: 0.5 s
""",
    "chest": """
objects:
  - name: chest
    static: true
    box: {size: [0.2, 0.2, 0.1]}
    pose: {xyz: [0.3, 0, 0.05]}
    joints:
      - name: lid
        hinge: {axis: [0, 1, 0], at: [0.1, 0, 0.05], range: [0, 110 deg], start: 70 deg}
        shapes: [{box: {size: [0.2, 0.2, 0.008]}, pose: {xyz: [0, 0, 0.054]}, color: red}]
steps:
  - wait: 1.5 s
""",
    "barrier": """
objects:
  - {name: ball, sphere: {radius: 0.03}, pose: {xyz: [0.3, 0, 0.03]}, color: red}
  - {name: post, static: true, box: {size: [0.02, 0.02, 0.12]}, pose: {xyz: [0.3, 0.14, 0.06]}}
  - {name: mirror, static: true, box: {size: [0.02, 0.02, 0.12]}, pose: {xyz: [0.3, -0.14, 0.06]}}
steps:
  - wait: 0.2 s
""",
    "camera": EYE % "0.12",
    "camera behind a wall": EYE % "-0.1",
}
PICTURES = {
    **pictures(),
    "sees": (
        ("camera", "{camera: eye, object: red_box}"),
        ("camera behind a wall", "{camera: eye, object: red_box}"),
    ),
}
"""For each predicate an expectation that passes and one that fails, each with its scene."""


def expectation(word: str, content: str) -> str:
    """The YAML of an expectation."""
    return content if content.startswith(("never:", "always:")) else f"{word}: {content}"


def scenario(title: str) -> str:
    """The file of a scene, with every expectation that a picture shows of it, in order."""
    shown = expectations_of(title)
    lines = "".join(f"  - {each}\n" for each in shown)
    return HEAD.format(title=title) + SCENES[title].strip("\n") + "\nexpect:\n" + lines


def expectations_of(title: str) -> list[str]:
    """The YAML of all expectations on a scene."""
    found = [
        expectation(word, content)
        for word, pair in PICTURES.items()
        for scene, content in pair
        if scene == title
    ]
    return list(dict.fromkeys(found))
