"""tcp_pose: the TCP, or another link, stands at a pose."""

from __future__ import annotations

from dataclasses import replace
from typing import Self

import numpy as np
from pydantic import Field, model_validator

from harness.cell.scope import At
from harness.core.amounts import amounts, is_exact
from harness.core.pose_arrays import compose, conjugate, quat_product, rotation_vector
from harness.judging.expectation import ArmPredicate
from harness.judging.margins import MarginSignal, Part, all_of
from harness.judging.observations import Observations
from harness.judging.poses import frame_poses, frame_present, link_poses
from harness.judging.window import Window
from harness.language.base import Flag, Name
from harness.language.expectation import Quantity
from harness.language.poses import Pose, PoseTolerance
from harness.recording.verdict import Measure

POSITION = Quantity("position error", "m", "at most the tolerance's `position`", "tcp")
ORIENTATION = Quantity(
    "orientation error", "rad", "at most its `orientation`, about each axis", "tcp"
)


class TcpPose(ArmPredicate):
    """The TCP, or another link, stands at a pose."""

    sentence = "[{link}|TCP] is at {pose}"
    quantities = (POSITION, ORIENTATION)
    is_proposed = True

    pose: Pose = Field(description="The expected pose of the link.")
    link: Name | None = Field(
        default=None, description="The link that is at the pose; by default the TCP."
    )
    tolerance: PoseTolerance = Field(
        default=PoseTolerance(), description="The tolerance of the pose; by default 1 mm, 0.01 rad."
    )
    position_only: Flag = Field(
        default=False, description="Whether the position alone counts, with any rotation."
    )

    @model_validator(mode="after")
    def _one_rotation(self) -> Self:
        if self.position_only and "orientation" in self.tolerance.model_fields_set:
            raise ValueError("a tolerance of the orientation says nothing with `position_only`")
        return self

    def check(self, at: At) -> None:
        at.scope.check_link(self.link, at.key("link"))
        if self.link is None:
            at.scope.check_arm(at.loc)
        link = self.link or at.scope.description.tcp_link
        at.scope.check_frame(self.pose.frame, at.key("pose", "frame"), of=link)

    def observations(self) -> Observations:
        links = () if self.link is None else (self.link,)
        return Observations(frozenset({self.pose.frame, *links}))

    def looks_back(self) -> float:
        return 0.0

    def signal(self, window: Window) -> MarginSignal:
        """Distance to the target, and the largest component of the rotation vector to it.

        A target in the frame of a moving link or object moves with it.
        """
        run = window.run
        link = self.link or run.robot.tcp_link
        what = "TCP" if link == run.robot.tcp_link else link
        target = window.cut(frame_poses(run, self.pose.frame))
        target = compose(target, self.pose.se3().as_vector())
        actual = window.cut(link_poses(run, link))
        distance = np.linalg.norm(actual[:, :3] - target[:, :3], axis=1)
        turn = np.abs(rotation_vector(quat_product(conjugate(target[:, 3:]), actual[:, 3:]))).max(
            axis=1
        )
        tolerance = self.tolerance
        points = (target[:, :3], actual[:, :3])
        position, orientation = self.quantities
        if link != run.robot.recorded_tcp:  # no plot shows other links
            position, orientation = (replace(each, plot="") for each in self.quantities)
        name = f"{what} {position.name}"
        parts = [
            Part(position, distance, tolerance.position, "<=", points=points, measured_name=name)
        ]
        if not self.position_only:
            name = f"{what} {orientation.name}"
            parts.append(Part(orientation, turn, tolerance.orientation, "<=", measured_name=name))

        def text(index: int, _: Measure) -> str:
            errors = [(float(part.values[index]), part.limit, part.unit) for part in parts]
            if all(is_exact(*error) for error in errors):
                allowed = " and ".join(amounts(*error)[1] for error in errors)
                return f"{what} is exactly at its target, {allowed} allowed"
            off = " and ".join(" of ".join(amounts(*error)) for error in errors)
            return f"{what} is off its target by {off}"

        return all_of(window, parts, text, present=window.cut(frame_present(run, self.pose.frame)))
