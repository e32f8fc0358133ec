"""Every YAML block of guides and reference pages is run, with what a page leaves to the reader."""

import re

import pytest
import yaml

from docs import ROOT
from tests.commands import harness
from tests.docs.test_examples import EVERY_PAGE, PAGES, page_id

BLOCK = re.compile(r"(?ms)^```yaml\b.*?\n(.*?)^```$")
QUOTED = re.compile(r"(?ms)^As in \[.*?^```yaml\n.*?^```$")
"""A part of a bundled scenario, which is run as a whole."""

UR3E = "robot: {model: ur3e, gripper: rh_p12_rn_a}\n"
LESSON = "robot: {model: ur3e, gripper: rh_p12_rn_a, base: {xyz: [0, 0, 1.02]}}\nworld: lesson_ur\n"
TWO_ARMS = """\
robots:
  left: {model: ur5e, gripper: rh_p12_rn_a, base: {xyz: [0, 0.45, 0]}}
  right: {model: ur5e, gripper: rh_p12_rn_a, base: {xyz: [0, -0.45, 0], rpy: [0, 0, 90 deg]}}
"""
BELT = """\
  - {name: belt, static: true, box: {size: [1.6, 0.25, 0.1]}, pose: {xyz: [0.1, 0.28, 0.05]},
     surface_velocity: %s}
  - {name: can, box: {size: [4 cm, 6 cm, 5 cm]}, pose: {xyz: [-0.4, 0.28, 0.125]}, mass: 0.2}
"""
PRESSES = """\
robot: {model: ur5e, gripper: rh_p12_rn_a, wrench_sensors: {wrist: rh_p12_rn_base}}
objects:
  - {name: block, static: true, friction: 0.1, box: {size: [0.3, 0.3, 0.15]},
     pose: {xyz: [0.5, 0.1, 0.075]}}
steps:
  - gripper: close
  - move_to: {pose: {xyz: [0.5, 0.1, 0.173], rpy: [180 deg, 0, 0]}}
  - tare: wrist
"""
CABINET = """\
robot: {model: ur5e, gripper: rh_p12_rn_a}
seed: 2
objects:
  - name: cabinet
    static: true
    pose: {xyz: [0.85, 0.1, 0.35]}
    box: {size: [30 cm, 40 cm, 40 cm]}
    joints:
      - name: door
        hinge: {axis: [0, 0, -1], at: [-0.16, 0.2, 0], range: [0, 110 deg], friction: 0.1}
        shapes:
          - {box: {size: [2 cm, 40 cm, 38 cm]}, pose: {xyz: [-0.162, 0, 0]}}
          - {name: handle, cylinder: {radius: 1 cm, length: 14 cm},
             pose: {xyz: [-0.22, -0.16, 0.1]}}
"""
BEFORE = {
    "docs/guides/belts.md": [
        "robot: ur5e\nsteps: [{wait: 0.5}]\n",
        f"{UR3E}objects:\n{BELT % 0}",
        f"{UR3E}objects:\n{BELT % 0.1}steps: [{{conveyor: {{object: belt, velocity: 0}}}}]\n",
        f"{UR3E}objects:\n{BELT % 0.1}expect: [{{lifted: {{object: can, above: 5 cm}}}}]\n",
        f"{UR3E}objects:\n{BELT % 0.1}",
    ],
    "docs/guides/cells.md": [
        "robot: {model: ur5e, gripper: rh_p12_rn_a}\nseed: 2\n",
        CABINET,
        UR3E
        + """\
objects:
  - {name: belt, static: true, box: {size: [1.4, 1.0, 0.1]}, pose: {xyz: [1.0, 0, -0.04]},
     surface_velocity: [-0.1, 0, 0]}
  - {name: box, box: {size: [6 cm, 6 cm, 10 cm]}, pose: {xyz: [0.8, 0, 0.06]}, mass: 0.2}
""",
        "steps: [{move_to: up}]\n",
    ],
    "docs/guides/contact.md": [
        "",
        PRESSES + "  - comply: {wrench: {z: -10 N}, during: [{wait: 0.8}]}\n",
        PRESSES,
        PRESSES,
        "robot: ur5e\nsteps: [{wait: 0.1}]\n",
        "robot: open_manipulator_x\nsteps: [{wait: 0.35}]\nobjects:\n"
        "  - {name: block, static: true, pose: {xyz: [0.5, 0.1, 0.025]},"
        " box: {size: [8 cm, 8 cm, 5 cm], hole: {diameter: 20.2 mm, depth: 40 mm}}}\n"
        "  - {name: peg, cylinder: {radius: 1 cm, length: 8 cm},"
        " pose: {xyz: [0.5, 0.1, 0.0905]}}\n",
        None,  # it is a part of the lesson
    ],
    "docs/guides/failure_search.md": [
        """\
objects:
  - {name: can, cylinder: {radius: 3 cm, length: 10 cm}, mass: 0.2, friction: "${friction}",
     pose: {xyz: ["${x}", 0.1, 0.05]}}
steps: [{move_to: {joints: {shoulder_lift_joint: -1.2}}}]
samples: 2
""",
        "robot: ur3e\nparams: {x: 1}\nrandomize: {x: {uniform: [0, 1]}}\nsamples: 1\n"
        "steps: [{wait: 0.1}]\nexpect: [{duration: 1 s, name: lifted}]\n",
    ],
    "docs/guides/motions.md": [
        UR3E + "objects: [{name: cup, cylinder: {radius: 3 cm, length: 10 cm}, mass: 0.2,"
        " pose: {xyz: [0.35, 0.15, 0.05]}}]\n"
    ],
    "docs/guides/moveit_pick_test.md": [""],
    "docs/guides/several_arms.md": [
        "",
        TWO_ARMS,
        TWO_ARMS,
        TWO_ARMS + "steps: [{move_to: {pose: {xyz: [0.5, 0.45, 0.3], rpy: [180 deg, 0, 0]}},"
        " robot: left}]\n",
        TWO_ARMS + "steps: [{pick: a, robot: left}]\nobjects:\n"
        "  - {name: a, box: {size: [5 cm, 5 cm, 8 cm]}, mass: 0.1, pose: {xyz: [0.5, 0.4, 0.04]}}\n"
        "  - {name: b, box: {size: [5 cm, 5 cm, 8 cm]}, mass: 0.1,"
        " pose: {xyz: [0.5, -0.4, 0.04]}}\n"
        "expect: [{placed: a}, {grasped: {object: b, by: right}}, {never: collision}]\n",
        TWO_ARMS + "steps: [{move_to: up, robot: left}]\nobjects: [{name: rod, mass: 0.1,"
        " box: {size: [2 cm, 2 cm, 20 cm]}, pose: {xyz: [0.5, 0.4, 0.1]}}]\n",
    ],
    "docs/guides/studio.md": [
        "robot: open_manipulator_x\nobjects:\n"
        "  - {name: red, box: {size: [3 cm, 3 cm, 3 cm]}, mass: 0.05,"
        " pose: {xyz: [0.2, 0.05, 0.015]}}\n"
        "  - {name: blue, box: {size: [3 cm, 3 cm, 3 cm]}, mass: 0.05,"
        " pose: {xyz: [0.2, -0.05, 0.015]}}\n"
        "expect: [{upright: red}]\n"
    ],
    "docs/guides/suction.md": ["", None],
    "docs/reference/expectations.md": [
        LESSON + "seed: 4\nsteps: [{move_to: mogi_home},"
        " {pick: {object: green_cylinder, lift: {distance: 10 cm}}}, {wait: 1 s}]\n",
        "robot: open_manipulator_x\nsteps: [{move_to: init}, {wait: 1 s, id: lift}]\nobjects:\n"
        "  - {name: red_box, box: {size: [3 cm, 3 cm, 3 cm]}, mass: 0.1,"
        " pose: {xyz: [0.2, 0, 0.015]}}\n",
    ],
    "docs/reference/steps.md": [LESSON],
}
"""What stands before or next to the blocks of a page: its other keys, and steps before its own.

None: a block of keys that need a peg, a block or a cup, as the scenarios in scenarios/contact and
the tests of the step have; its schema alone is checked here.
"""

ELSEWHERE = {
    "README.md": "tests/docs/test_readme.py: it is the file of a lesson",
    "docs/guides/bring_your_own_arm.md": "tests/packages/test_bring_your_own_arm.py",
    "docs/guides/extending.md": "tests/docs/test_contributing.py",
    "docs/guides/many_machines.md": "tests/plugins/campaigns/test_shards.py",
    "docs/guides/pipelines.md": "tests/plugins/ci/test_pipelines.py, by actionlint",
    "docs/guides/python.md": "tests/suite/test_api.py",
    "docs/guides/ros2.md": "tests/docs/test_ros2_page.py",
    "docs/reference/robot_formats.md": "tests/robot/test_formats.py, with files in these formats",
    "docs/reference/robot_packages.md": "tests/packages/test_packages.py",
    "docs/reference/world_formats.md": "tests/world, with files in these formats",
}
"""Pages whose blocks other tests run."""


def blocks(page):
    text = QUOTED.sub("", page.read_text(encoding="utf-8"))
    return BLOCK.findall(text)


CASES = [
    pytest.param(before, block, id=f"{name.removeprefix('docs/').removesuffix('.md')}-{number}")
    for name, contexts in BEFORE.items()
    for number, (before, block) in enumerate(
        zip(contexts, blocks(ROOT / name), strict=True)
    )
    if before is not None
]  # fmt: skip


@pytest.mark.nightly(but=["reference/expectations-1", "guides/belts-0"])
@pytest.mark.parametrize(("before", "block"), CASES)
def test_a_block_runs_and_passes(before, block, tmp_path):
    own = yaml.safe_load(f"steps:\n{block}" if block.startswith("- ") else block)
    given = yaml.safe_load(before) or {}
    steps = [*given.get("steps", []), *own.get("steps", [])]
    content = {"scenario": "a block", **given, **own, "steps": steps}
    file = tmp_path / "block.scenario.yaml"
    file.write_text(yaml.safe_dump(content, sort_keys=False), encoding="utf-8")
    done = harness("run", file, "--no-report", cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_blocks_of_every_page_are_run_somewhere():
    named = {page_id(page) for page in EVERY_PAGE if blocks(page) and page not in PAGES}
    assert named == {*BEFORE, *ELSEWHERE}
    for reason in ELSEWHERE.values():
        assert (ROOT / re.match(r"[\w/.]+?(?=[:,]|$)", reason)[0]).exists(), reason
