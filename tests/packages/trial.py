"""One arm of a package: loaded, its two models compared, moved, and picking a box."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pinocchio as pin

from harness.core.errors import HarnessError, SpecError
from harness.language.scenario import RobotSpec
from harness.planning.backend import make_planning
from harness.plugins.authoring.first_scenario import first_scenario
from harness.plugins.authoring.robot_check import check_robot
from harness.robot.description import RobotDescription
from harness.robot.find_file import find_file
from harness.robot.load import load_robot
from harness.robot.robot_source import RobotSource, load_source
from harness.simulation.servo import bare_robot
from tests.packages.arms import PackageArm
from tests.running import run_case

MOST_STATES = 10
"""Random free states of which one has to be reached: not all can be, from where the arm stands."""


@dataclass
class Trial:
    """What became of an arm.

    Attributes:
        joints: Of its group.
        mass: Of the whole robot in physics [kg].
        is_mass_estimated: Whether the file lacks masses, so that some follow from volumes.
        mass_difference: Between physics and the file [kg]; 0 where the file lacks masses.
        position_difference: The largest of any link at random states [m].
        srdf: What became of the SRDF it came with.
        moved: How many random free states were tried until one was reached; 0 if none was.
        reason: Why it did not get to the end.
    """

    joints: int = 0
    mass: float = float("nan")
    is_mass_estimated: bool = False
    mass_difference: float = float("nan")
    position_difference: float = float("nan")
    srdf: str = "none"
    moved: int = 0
    reason: str = ""


def try_arm(arm: PackageArm, folder: Path) -> Trial:
    """Load an arm, compare its two models, and let it move to a random free state."""
    trial = Trial()
    try:
        words, description = loaded(arm, trial)
    except HarnessError as error:
        trial.reason = brief(error)
        return trial
    trial.joints = len(description.groups[description.arm_group].joint_names)
    compare(arm, description, trial)
    for number, goal in enumerate(free_states(description), 1):
        result = run_case(scenario(words, goal, folder), report_dir=None, stills=False)
        if result.outcome == "passed":
            trial.moved, trial.reason = number, ""
            return trial
        said = [str(problem) for problem in result.problems]
        said += [step.message for step in result.steps if step.message]
        said += [f"{v.expectation}: {v.reason}" for v in result.verdicts if v.status != "passed"]
        trial.reason = (said or [result.message])[0]
    trial.reason = trial.reason or "no free state among the random ones"
    return trial


@dataclass(frozen=True)
class PickTrial:
    """What became of a scenario that `harness new` wrote for an arm with fingers.

    Attributes:
        wrong: What `harness robot check` finds wrong, the first of each kind.
        picks: Whether the scenario is a pick, which was run once and passed.
        reason: Why it is not.
    """

    wrong: tuple[str, ...]
    picks: bool
    reason: str


def try_pick(arm: PackageArm, folder: Path) -> PickTrial:
    """Look an arm over, and let a first scenario be written and run."""
    words, _ = loaded(arm, Trial())
    uri = str(words[arm.kind])
    source = RobotSource(uri, srdf=str(words.get("srdf", "")), **arm.options)
    found = check_robot(load_source(source), uri, samples=200).report.findings
    wrong = tuple((each.details or (each.text,))[0] for each in found if not each.is_good)
    written = first_scenario(source, folder / "first.scenario.yaml")
    reason = written.no_pick or written.trouble
    return PickTrial(wrong, not reason, reason)


def loaded(arm: PackageArm, trial: Trial) -> tuple[dict[str, object], RobotDescription]:
    """The arm with its SRDF, or without where that does not fit it."""
    words = arm.words(with_srdf=True)
    if arm.srdf:
        try:
            description = load_robot(RobotSpec.model_validate(words))
        except SpecError as error:
            trial.srdf = f"refused: {brief(error)}"
            words = arm.words(with_srdf=False)
        else:
            trial.srdf = "used"
            return words, description
    return words, load_robot(RobotSpec.model_validate(words))


def brief(error: HarnessError) -> str:
    """The first line of a message, files by their bare names."""
    first = str(error).splitlines()[0]
    return " ".join(word.rpartition("/")[2] if word[:1] == "/" else word for word in first.split())


def compare(arm: PackageArm, description: RobotDescription, trial: Trial) -> None:
    """Masses and link positions of MuJoCo's model against Pinocchio's own reading of the file.

    Pinocchio does not read xacro: of such an arm it reads the URDF that the program composed.
    """
    physics = bare_robot(description).compile()
    if arm.kind == "urdf":
        path = find_file(str(arm.words(with_srdf=False)["urdf"]), "urdf", Path(), ())
        planner = pin.buildModelFromUrdf(str(path))
    else:
        planner = pin.buildModelFromXML(description.urdf)
    trial.mass = float(physics.body_mass.sum())
    trial.is_mass_estimated = any(note.startswith("no mass is given") for note in description.notes)
    total = pin.computeTotalMass(planner) + float(planner.inertias[0].mass)
    trial.mass_difference = 0.0 if trial.is_mass_estimated else abs(total - trial.mass)
    rng, worst = np.random.default_rng(1), 0.0
    for _ in range(5):
        positions = description.with_mimics(random_positions(description, rng))
        values = dict(zip(description.joint_names, positions, strict=True))
        worst = max(worst, largest_difference(planner, physics, values))
    trial.position_difference = worst


def largest_difference(planner: Any, physics: Any, values: dict[str, float]) -> float:
    """Of the positions of all links, from the robot's root [m]."""
    configuration = pin.neutral(planner)
    for name, value in values.items():
        joint = planner.joints[planner.getJointId(name)]
        numbers = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        configuration[joint.idx_q : joint.idx_q + joint.nq] = numbers
    known, there = planner.createData(), mujoco.MjData(physics)
    pin.framesForwardKinematics(planner, known, configuration)
    for name, value in values.items():
        there.joint(name).qpos = value
    mujoco.mj_kinematics(physics, there)
    bodies = {physics.body(body).name for body in range(physics.nbody)}
    gaps = [
        there.body(frame.name).xpos - known.oMf[number].translation
        for number, frame in enumerate(planner.frames)
        if frame.type == pin.FrameType.BODY and frame.name in bodies
    ]
    assert len(gaps) > len(values)
    return float(np.abs(gaps).max())


def random_positions(description: RobotDescription, rng: np.random.Generator) -> np.ndarray:
    """Inside the limits; half a turn each way where there are none."""
    joints = description.movable_joints
    lower = [joint.lower if np.isfinite(joint.lower) else -np.pi for joint in joints]
    upper = [joint.upper if np.isfinite(joint.upper) else np.pi for joint in joints]
    return rng.uniform(lower, upper)


def free_states(description: RobotDescription) -> list[dict[str, float]]:
    """Joint positions of the arm that touch nothing, the rest of the robot as it starts."""
    scene, _, _ = make_planning(description)
    rng = np.random.default_rng(7)
    names = description.groups[description.arm_group].joint_names
    found: list[dict[str, float]] = []
    for _ in range(50 * MOST_STATES):
        drawn = dict(zip(description.joint_names, random_positions(description, rng), strict=True))
        start = dict(zip(description.joint_names, description.start_positions(), strict=True))
        start |= {joint: float(drawn[joint]) for joint in names}
        positions = description.with_mimics(np.array(list(start.values())))
        if not scene.touches(positions):
            found.append({joint: start[joint] for joint in names})
        if len(found) == MOST_STATES:
            break
    return found


def scenario(words: dict[str, object], goal: dict[str, float], folder: Path) -> Path:
    """A scenario file with one motion."""
    robot = "".join(f"\n  {key}: {value}" for key, value in words.items())
    joints = "".join(f"\n      {joint}: {value!r}" for joint, value in goal.items())
    path = folder / "arm.scenario.yaml"
    path.write_text(
        f"scenario: To a random free state\nrobot:\n  base: {{xyz: [0, 0, 2]}}{robot}\n"
        f"steps:\n  - move_to:\n     joints:{joints}\nexpect:\n  - always: within_limits\n",
        encoding="utf-8",
    )
    return path
