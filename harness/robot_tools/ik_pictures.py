"""Pictures of the targets of inverse kinematics and its answers."""

from __future__ import annotations

from pathlib import Path

from harness.core.types import FloatArray
from harness.robot.chain import Chain
from harness.strategies.poses import Target


def draw_ik_example(
    chain: Chain, target: Target, answer: FloatArray | None, file: Path, caption: str
) -> None:
    """Draw an arm where an answer puts it, translucent where the target is reached.

    Args:
        chain: The chain of the arm.
        target: The requested pose; its frame is drawn.
        answer: The group's positions; None draws what reaches the target alone.
        file: The JPEG file to write.
        caption: The caption below the picture.
    """
    from harness.cameras.ik_comparison_picture import draw_ik_comparison

    way = target.joint_positions
    requested = None if way is None else chain.whole(way)
    reached = None if answer is None else chain.whole(answer)
    draw_ik_comparison(
        chain.description, chain.link, target.pose, requested, reached, file, caption
    )
