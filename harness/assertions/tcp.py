"""tcp_pose and path_length: where the TCP, or another link, stands and how far it travels."""

from __future__ import annotations

import numpy as np

from harness.assertions.poses import frame_poses, link_poses
from harness.assertions.registry import MarginSignal, Part, all_of, signal
from harness.assertions.text import amounts
from harness.assertions.window import Window
from harness.core.pose_arrays import compose, conjugate, quat_product, rotation_vector
from harness.recording.run import Measure
from harness.spec.checks import PathLength, TcpPose


@signal.handles(TcpPose)
def tcp_pose(check: TcpPose, window: Window) -> MarginSignal:
    """Distance to the target, and the largest component of the rotation vector to it.

    A target in the frame of a moving link or object moves with it.
    """
    run = window.run
    link = check.link or run.robot.tcp_link
    what = "TCP" if link == run.robot.tcp_link else link
    target = window.cut(frame_poses(run, check.pose.frame))
    target = compose(target, check.pose.se3().as_vector())
    actual = window.cut(link_poses(run, link))
    distance = np.linalg.norm(actual[:, :3] - target[:, :3], axis=1)
    turn = np.abs(rotation_vector(quat_product(conjugate(target[:, 3:]), actual[:, 3:]))).max(
        axis=1
    )
    tolerance = check.tolerance
    points = (target[:, :3], actual[:, :3])
    parts = [Part(f"{what} position error", distance, tolerance.position, "<=", "m", points=points)]
    if not check.position_only:
        parts.append(Part(f"{what} orientation error", turn, tolerance.orientation, "<=", "rad"))

    def text(index: int, _: Measure) -> str:
        errors = " and ".join(
            " of ".join(amounts(float(part.values[index]), part.limit, part.unit)) for part in parts
        )
        return f"{what} is off its target by {errors}"

    return all_of(window, parts, text)


@signal.handles(PathLength)
def path_length(check: PathLength, window: Window) -> MarginSignal:
    """Distance travelled by the TCP since the window's start [m]."""
    moves = np.diff(window.cut(window.run.signals.tcp_pose)[:, :3], axis=0)
    travelled = np.concatenate([[0.0], np.cumsum(np.linalg.norm(moves, axis=1))])
    parts: list[Part] = []
    if check.at_most is not None:
        parts.append(Part("path length", travelled, check.at_most, "<=", "m"))
    if check.at_least is not None:
        parts.append(Part("path length", travelled, check.at_least, ">=", "m"))

    def text(_: int, measure: Measure) -> str:
        bound = "at most" if measure.comparison == "<=" else "at least"
        travelled, limit = amounts(measure.value, measure.limit, "m")
        return f"the TCP travelled {travelled}, {bound} {limit} required"

    return all_of(window, parts, text)
