"""Scenes about links inside each other whose contact the SRDF excludes: an arm in the plane.

Its shapes lie along straight lines, so that geometry in the plane says whether two overlap.
"""

from __future__ import annotations

import numpy as np

from harness.recording.run import Run
from tests.adversarial.scenes import Scene

LENGTHS = {"upper": 0.2, "lower": 0.2, "hand": 0.1}
HALF_BASE, HALF_WIDTH = 0.03, 0.02


def _link(name: str, length: float) -> str:
    shape = f'<origin xyz="{length / 2} 0 0"/><geometry><box size="{length} 0.04 0.04"/></geometry>'
    inertial = (
        f'<inertial><origin xyz="{length / 2} 0 0"/><mass value="0.3"/>'
        '<inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial>'
    )
    return f'<link name="{name}">{inertial}<collision>{shape}</collision></link>'


def _joint(name: str, parent: str, child: str, x: float, kind: str = "revolute") -> str:
    limit = '<limit lower="-3" upper="3" velocity="2" effort="20"/>' if kind == "revolute" else ""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{x} 0 0"/><axis xyz="0 0 1"/>{limit}</joint>'
    )


URDF = (
    '<robot name="folding"><link name="base"><collision><geometry><box size="0.06 0.06 0.1"/>'
    "</geometry></collision></link>"
    + "".join(_link(name, length) for name, length in LENGTHS.items())
    + '<link name="tip"/>'
    + _joint("shoulder", "base", "upper", 0)
    + _joint("elbow", "upper", "lower", 0.2)
    + _joint("wrist", "lower", "hand", 0.2)
    + _joint("tool", "hand", "tip", 0.1, "fixed")
    + "</robot>"
)
EXCLUDED = {
    "Adjacent": (("base", "upper"), ("upper", "lower"), ("lower", "hand")),
    "Never": (("base", "lower"), ("base", "hand"), ("upper", "hand")),
}
SRDF = (
    '<robot name="folding"><group name="arm"><chain base_link="base" tip_link="tip"/></group>'
    + "".join(
        f'<disable_collisions link1="{first}" link2="{second}" reason="{reason}"/>'
        for reason, pairs in EXCLUDED.items()
        for first, second in pairs
    )
    + "</robot>"
)
ROBOT = "{urdf: folding.urdf, srdf: folding.srdf, base: {xyz: [0, 0, 0.3]}}"
FILES = {"folding.urdf": URDF, "folding.srdf": SRDF}


def _fold(shoulder: float, elbow: float, wrist: float) -> str:
    return (
        f"steps:\n  - ptp: {{joints: {{shoulder: {shoulder}, elbow: {elbow}, wrist: {wrist}}}}}\n"
        "  - wait: 0.1 s\n"
    )


def frames(run: Run, sample: int = -1) -> dict[str, tuple[np.ndarray, float]]:
    """Origin and heading of each link in the plane."""
    origin, heading = np.zeros(2), 0.0
    found: dict[str, tuple[np.ndarray, float]] = {}
    angles = run.signals.joint_positions[sample]
    for (name, length), angle in zip(LENGTHS.items(), angles, strict=True):
        heading += float(angle)
        found[name] = origin, heading
        origin = origin + length * np.array([np.cos(heading), np.sin(heading)])
    return found


def points_of(run: Run, link: str, sample: int = -1) -> np.ndarray:
    """A grid of points of a link in the plane, 1 mm inside its edges, shape (n, 2)."""
    origin, heading = frames(run, sample)[link]
    along = np.linspace(1e-3, LENGTHS[link] - 1e-3, 60)
    across = np.linspace(-HALF_WIDTH + 1e-3, HALF_WIDTH - 1e-3, 20)
    grid = np.stack(np.meshgrid(along, across), axis=-1).reshape(-1, 2)
    turn = np.array([[np.cos(heading), np.sin(heading)], [-np.sin(heading), np.cos(heading)]])
    return origin + grid @ turn


def inside_base(run: Run, link: str, room: float = 0.0) -> bool:
    """Whether a point of a link is inside the base, or some room around it [m], at the end."""
    return bool((np.abs(points_of(run, link)) < HALF_BASE + room).all(axis=1).any())


def inside_upper(run: Run, link: str) -> bool:
    """Whether a point of a link is inside the upper link at the end."""
    origin, heading = frames(run)["upper"]
    off = points_of(run, link) - origin
    along = off @ [np.cos(heading), np.sin(heading)]
    across = off @ [-np.sin(heading), np.cos(heading)]
    return bool(((along > 0) & (along < 0.2) & (np.abs(across) < HALF_WIDTH)).any())


def no_link_touches(run: Run) -> bool:
    """No contact between links was recorded."""
    links = set(run.robot.link_names)
    return not any(set(pair) <= links for pair in run.signals.contact_forces)


KEEPS_AWAY = "clearance: {between: [robot, robot], at_least: 1 cm}"
STRICT = "never: {collision: {count_allowed: true}}"
OVERLAP_SCENES = (
    Scene(
        "arm folded into its base",
        "the hand ends inside the base, a pair that the SRDF calls `Never`",
        _fold(0, 2.75, 1.53),
        "the physics recorded no contact between links",
        no_link_touches,
        (STRICT, KEEPS_AWAY),
        ("never: {collision: {between: [upper, lower], count_allowed: true}}",),
        truth=lambda run: inside_base(run, "hand"),
        robot=ROBOT,
        files=FILES,
    ),
    Scene(
        "hand folded through the upper arm",
        "elbow and wrist turn so far that the hand lies across the upper arm",
        _fold(0, 2.6, 2.58),
        "the physics recorded no contact between links",
        no_link_touches,
        (STRICT, "formula: always distance(robot, robot) > 1 mm"),
        ("never: {collision: {between: [base, hand], count_allowed: true}}",),
        truth=lambda run: inside_upper(run, "hand") and not inside_base(run, "hand"),
        robot=ROBOT,
        files=FILES,
    ),
    Scene(
        "lower arm through the base",
        "the elbow turns until the lower arm lies in the base",
        _fold(0, 3, -1.5),
        "the physics recorded no contact between links",
        no_link_touches,
        (STRICT,),
        ("never: {collision: {between: [upper, lower], count_allowed: true}}",),
        truth=lambda run: inside_base(run, "lower"),
        robot=ROBOT,
        files=FILES,
    ),
    Scene(
        "arm folded to within 5 mm of its base",
        "the lower arm comes near the base, a pair that the SRDF calls `Never`",
        _fold(0, 2.835, 0.1),
        "no link is inside another one that it is not joined to",
        lambda run: not inside_base(run, "lower"),
        (KEEPS_AWAY,),
        (STRICT,),
        truth=lambda run: not inside_base(run, "lower") and inside_base(run, "lower", 0.005),
        robot=ROBOT,
        files=FILES,
    ),
    Scene(
        "links that overlap at their joints",
        "the boxes of neighbours overlap around each joint, by design, and nothing else does",
        _fold(0.5, 1.2, -0.8),
        "shapes of an excluded pair overlap: too strict",
        lambda run: inside_base(run, "upper") and inside_upper(run, "lower"),
        (),
        (STRICT, KEEPS_AWAY),
        truth=lambda run: (
            not (inside_base(run, "lower") or inside_base(run, "hand") or inside_upper(run, "hand"))
        ),
        robot=ROBOT,
        files=FILES,
    ),
)
