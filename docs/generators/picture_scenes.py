"""The short scenarios that pictures of expectations are drawn from, and those expectations."""

from tests.assertions.evidence import collected

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
    "camera": EYE % "0.12",
    "camera behind a wall": EYE % "-0.1",
}
LINE = "{line: {start: {xyz: [0.2, -0.08, 0.1]}, end: {xyz: [0.2, 0.08, 0.1]}}, "
BACK = "{line: {start: {xyz: [0.2, 0.08, 0.1]}, end: {xyz: [0.2, -0.08, 0.1]}}, "
PICTURES = {
    **{word: evidence.picture for word, evidence in collected().items()},
    "lifted": (
        ("pick", "{object: red_box, above: 5 cm, for: 0.5 s}"),
        ("slippery", "{object: red_box, above: 5 cm, for: 1 s}"),
    ),
    "grasped": (
        ("pick", "{object: red_box, during: lift}"),
        ("slippery", "{object: red_box, during: hold}"),
    ),
    "released": (("pick", "red_box"), ("pick", "{object: red_box, during: lift}")),
    "placed": (("pick", "red_box"), ("pick", "{object: red_box, during: hold}")),
    "on": (
        ("pick", "{object: red_box, support: ground_plane}"),
        ("pick", "{object: red_box, support: ground_plane, during: lift}"),
    ),
    "in": (
        ("cup", "{object: ball, container: cup}"),
        ("tipping cup", "{object: ball, container: cup}"),
    ),
    "displaced": (
        ("pick", "{object: red_box, at_least: 5 cm, during: lift}"),
        ("pick", "{object: red_box, at_least: 5 cm}"),
    ),
    "static": (
        ("pick", "red_box"),
        ("pick", "always: {static: {object: red_box, during: lift}}"),
    ),
    "in_contact": (
        ("pick", "{between: [gripper, red_box]}"),
        ("pick", "{between: [gripper, red_box], min_force: 40 N}"),
    ),
    "collision": (("pick", "never: {collision: {}}"), ("wall", "never: {collision: {}}")),
    "clearance": (
        ("pick", "{between: [robot, post], at_least: 4 cm}"),
        ("pick", "{between: [robot, post], at_least: 8 cm}"),
    ),
    "tcp_pose": (
        ("pick", "{pose: {xyz: [0.25, 0, 0.06]}, position_only: true, during: reach}"),
        ("pick", "{pose: {xyz: [0.252, 0, 0.06]}, position_only: true, during: reach}"),
    ),
    "tcp_path": (
        ("paths", LINE + "max_deviation: 2 mm, during: straight}"),
        ("paths", BACK + "max_deviation: 2 mm, during: bent}"),
    ),
    "joints": (
        ("late", "{positions: {joint1: 40 deg}, tolerance: 1 deg}"),
        ("stalled", "{positions: {joint1: 40 deg}, tolerance: 1 deg}"),
    ),
    "named_target": (("pick", "{state: open, group: gripper}"), ("wall", "home")),
    "gripper": (("pick", "open"), ("pick", "close")),
    "within_limits": (
        ("late", "always: {within_limits: {position: false, effort: false}}"),
        ("hammer", "always: {within_limits: {position: false, effort: false}}"),
    ),
    "tracking_error": (("pick", "1 deg"), ("late", "1 deg")),
    "effort": (("pick", "0.9"), ("wall", "0.9")),
    "duration": (
        ("pick", "{at_most: 2 s, during: lift}"),
        ("pick", "{at_most: 0.8 s, during: lift}"),
    ),
    "path_length": (
        ("paths", "{at_most: 16.2 cm, during: straight}"),
        ("paths", "{at_most: 16.2 cm, during: bent}"),
    ),
    "fraction": (("paths", "{at_least: 0.4}"), ("paths", "{at_least: 0.5}")),
    "sees": (
        ("camera", "{camera: eye, object: red_box}"),
        ("camera behind a wall", "{camera: eye, object: red_box}"),
    ),
    "slip": (("pick", "red_box"), ("slippery", "red_box")),
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
