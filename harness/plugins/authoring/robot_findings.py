"""The checks of a robot: one function for each finding."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from harness.core.types import FloatArray
from harness.planning.collision.scene import CoalScene
from harness.planning.ik.kinematics import PinocchioKinematics
from harness.plugins.authoring.agreement import link_poses_in_physics
from harness.plugins.authoring.doubtful_masses import mass_notes
from harness.plugins.authoring.ik_trial import IkTrial
from harness.plugins.authoring.mass_problems import mass_problems
from harness.plugins.authoring.pair_statistics import SelfTouches
from harness.plugins.authoring.robot_report import RobotFinding
from harness.robot.collision_shapes import mesh_shapes
from harness.robot.description import RobotDescription
from harness.robot.mechanism import Link
from harness.robot.solids import box_corners, coal_geometry

AGREEMENT = 1e-9  # [m], of the two libraries, and in parts of a quaternion and of the mass

ENOUGH_SOLVED = 0.9  # share of reachable poses; less is reported
TOO_OFTEN = 0.9  # share of colliding configurations of a wrong, not a crowded, description

PLACEHOLDER_EFFORT = 1000.0  # [N or N m], which exporters write where they know none
MOST_TURNS = 10  # Turns of a revolute joint from which its limits are in degrees in all likelihood
SHOWN_EXCESS = 5e-5  # [m], of a mesh's collision shapes that is said of each mesh
LARGEST_LINK = 10.0  # Length of a shape from which it is in millimetres in all likelihood [m]


def forward_kinematics(
    description: RobotDescription, kinematics: PinocchioKinematics, positions: FloatArray
) -> RobotFinding:
    """Link poses and the mass in Pinocchio's model and in MuJoCo's, positions (N, n)."""
    links = description.link_names[1:]  # `world` is in no description
    ours = kinematics.link_poses(positions, links)
    theirs, mass = link_poses_in_physics(description, positions)
    shift = np.linalg.norm(ours[..., :3] - theirs[..., :3], axis=-1)
    apart = (ours[..., 3:] - theirs[..., 3:], ours[..., 3:] + theirs[..., 3:])
    turn = np.minimum(*(np.linalg.norm(each, axis=-1) for each in apart))
    most = float(shift.max(initial=0.0))
    agrees = max(most, float(turn.max(initial=0.0))) <= AGREEMENT
    described = _mass(description.links)
    weighs = abs(mass - described) <= AGREEMENT * max(1.0, described)
    text = (
        f"Pinocchio and MuJoCo differ by at most {most:.1g} m"
        f" ({len(positions)} configurations, {len(links)} links)"
    )
    details: list[str] = []
    if not agrees:
        _, worst = np.unravel_index(int((shift + turn).argmax()), shift.shape)
        details.append(f"most at {links[worst]}")
    if not weighs:
        details.append(f"MuJoCo has {mass:.9g} kg, the description {described:.9g} kg")
    values = {"position_error": most, "mass_in_physics": mass}
    return RobotFinding("forward kinematics", text, agrees and weighs, tuple(details), values)


def masses(description: RobotDescription) -> RobotFinding:
    """Whether masses and inertias are those of bodies, and what looks like a placeholder."""
    problems, notes = mass_problems(description), mass_notes(description)
    moving = [link for link in description.links if link.name not in description.static_links]
    total, heavy = _mass(description.links), moving_mass(description)
    weightless = [link.name for link in moving if link.inertial is None and link.collisions]
    if weightless:
        notes.append(f"no <inertial>: {', '.join(weightless)}")
    text = f"{total:.4g} kg, {heavy:.4g} kg of it moving"
    values = {"mass": total, "moving_mass": heavy, "problems": len(problems)}
    return RobotFinding("masses", text, not problems, (*problems, *notes), values)


def limits(description: RobotDescription) -> RobotFinding:
    """Which limits are missing, or stand for "I do not know"; readers refuse those without room."""
    notes: list[str] = []
    for joint in description.movable_joints:
        if joint.mimic is not None:
            continue
        if not np.isfinite(joint.effort):
            notes.append(f"{joint.name} has no effort limit")
        elif joint.effort >= PLACEHOLDER_EFFORT:
            notes.append(f"{joint.name}: an effort of {joint.effort:g} is a placeholder")
        if joint.kind == "revolute" and joint.upper - joint.lower > MOST_TURNS * math.tau:
            notes.append(
                f"{joint.name}: {joint.lower:g} to {joint.upper:g} rad are"
                f" {(joint.upper - joint.lower) / math.tau:.0f} turns; degrees are"
                f" {math.radians(joint.lower):.3g} to {math.radians(joint.upper):.3g} rad"
            )
    count = len(description.movable_joints)
    text = f"{count} joint{'s move' if count != 1 else ' moves'}"
    return RobotFinding("limits", text, details=tuple(notes))


def sizes(description: RobotDescription) -> RobotFinding | None:
    """Links that are too large for an arm; None where there are none."""
    lengths: dict[str, float] = {}
    for link in description.links:
        for shape in link.collisions:
            corners = box_corners(coal_geometry(shape))
            length = float((corners.max(axis=0) - corners.min(axis=0)).max())
            lengths[link.name] = max(length, lengths.get(link.name, 0.0))
    details = tuple(
        f"{name}: a shape is {length:.3g} m long; files in millimetres need `scale` 0.001"
        for name, length in lengths.items()
        if length > LARGEST_LINK
    )
    if not details:
        return None
    text = f"{len(details)} of {len(lengths)} links are larger than {LARGEST_LINK:g} m"
    return RobotFinding("sizes", text, is_good=False, details=details)


def states(description: RobotDescription) -> RobotFinding:
    """Whether the start and the named states are free of self-collision, inside the limits.

    A state of the gripper is one in itself: the arm may be anywhere.
    """
    scene = CoalScene(description)
    hand, every = description.gripper, set(description.link_names)
    looked_at = {"the start": (description.start_positions(), every)}
    for state in description.named_states:
        is_hand = hand is not None and state.group == hand.group
        links = {hand.palm_link, *hand.links} if hand and is_hand else every
        row = description.start_positions(state.positions)
        looked_at[f"{state.name} ({state.group})"] = row, links
    problems: dict[str, list[str]] = {}
    for name, (row, links) in looked_at.items():
        touches = [each for each in scene.touches(row) if {each.first, each.second} <= links]
        found = [f"{touch.first} touches {touch.second}" for touch in touches[:1]]
        found += [
            f"{joint.name} at {value:.4g} is outside {joint.lower:.4g} to {joint.upper:.4g}"
            for joint, value in zip(description.movable_joints, row, strict=True)
            if joint.mimic is None and not joint.lower - 1e-9 <= value <= joint.upper + 1e-9
        ]
        if found:
            problems[name] = found
    text = f"{len(looked_at) - 1} and the start are free" if len(looked_at) > 1 else "none"
    if problems:
        text = f"{len(problems)} of {len(looked_at)} cannot be taken"
    details = tuple(f"{name}: {each}" for name, found in problems.items() for each in found)
    return RobotFinding("named states", text, not problems, details)


def shapes(description: RobotDescription) -> RobotFinding | None:
    """What stands for the meshes with which the links collide; None where there are none."""
    found = mesh_shapes({link.name: link.collisions for link in description.links})
    if not found:
        return None
    count = sum(max(each.parts, 1) for each in found)
    excess = max(each.excess for each in found)
    text = (
        f"{count} convex shapes stand for {len(found)} meshes, at most {1e3 * excess:.1f} mm larger"
    )
    values = {"parts": count, "meshes": len(found), "excess": excess}
    details = tuple(str(each) for each in found if each.excess >= SHOWN_EXCESS)
    return RobotFinding("collision shapes", text, True, details, values)


def self_collisions(touches: SelfTouches) -> RobotFinding:
    """How often the robot touches itself, and where most."""
    allowed = len(touches.description.allowed_collisions)
    frequent = touches.most_frequent(3)
    text = (
        f"{touches.rate:.1%} of {len(touches.touched)} random configurations;"
        f" {allowed} pairs are allowed"
    )
    values = {
        "rate": touches.rate,
        "most_frequent": [[*pair, rate] for pair, rate in frequent],
        "allowed_pairs": allowed,
    }
    details = tuple(f"{first} - {second}: {rate:.1%}" for (first, second), rate in frequent)
    return RobotFinding("self-collisions", text, touches.rate < TOO_OFTEN, details, values)


def reach(
    description: RobotDescription, kinematics: PinocchioKinematics, positions: FloatArray
) -> RobotFinding:
    """How far the TCP comes, at positions free of self-collision, shape (N, n)."""
    if not len(positions):
        return RobotFinding("reach", "no configuration is free of self-collision", is_good=False)
    links = (description.base_link, description.tcp_link)
    poses = kinematics.link_poses(positions, links)[:, :, :3]
    away = float(np.linalg.norm(poses[:, 1] - poses[:, 0], axis=1).max())
    low, high = poses[:, 1].min(axis=0), poses[:, 1].max(axis=0)
    sides = zip("xyz", low, high, strict=True)
    box = ", ".join(f"{axis} {first:.2f} to {last:.2f}" for axis, first, last in sides)
    text = f"{description.tcp_link} comes {away:.3g} m from {description.base_link}; {box} m"
    values = {"reach": away, "workspace": [low.tolist(), high.tolist()]}
    return RobotFinding("reach", text, details=(), values=values)


def inverse_kinematics(trial: IkTrial) -> RobotFinding:
    """How many of the poses that can be taken are solved, and by what."""
    text = f"{trial.solver} solves {trial.solved} of {trial.poses} poses that can be taken"
    if trial.solved:
        text += f", to {trial.worst:.1g} m"
    values = {"solver": trial.solver, "success_rate": trial.rate}
    return RobotFinding("inverse kinematics", text, trial.rate >= ENOUGH_SOLVED, (), values)


def moving_mass(description: RobotDescription) -> float:
    """Mass of the links that a joint moves [kg]."""
    fixed = description.static_links
    return _mass([link for link in description.links if link.name not in fixed])


def _mass(links: Sequence[Link]) -> float:
    return sum(link.inertial.mass for link in links if link.inertial)
