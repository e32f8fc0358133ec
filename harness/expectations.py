"""What a package needs to add an expectation of its own, and the built-in ones by their names.

The modules of `harness.judging.expectations` hold the built-in expectations; the class of one is
imported when it is first named. A package of its own names its modules in the entry-point group
`harness.plugins`:

    from harness.expectations import Length, Margin, Predicate, Window


    class TcpHeight(Predicate):
        \"\"\"The TCP is at least this high above the world's origin.\"\"\"

        at_least: Length

        def signal(self, window: Window) -> Margin:
            return window.tcp_position[:, 2] - self.at_least
"""

from typing import Any

from harness.cell.scope import At, Scope
from harness.core.amounts import amount, amounts
from harness.core.registry import built_in_class
from harness.judging.contacts import force_between
from harness.judging.expectation import Expectation, ObjectPredicate, Predicate, TemporalWord
from harness.judging.margins import Evidence, Margin, MarginSignal, Part, all_of, measured
from harness.judging.observations import Observations, PictureRequest
from harness.judging.poses import frame_poses, object_poses, present
from harness.judging.window import NotObservable, NotReached, Window
from harness.language.base import (
    Angle,
    AngleBetween,
    AngularVelocity,
    Count,
    Duration,
    Flag,
    Force,
    Fraction,
    JointValue,
    Length,
    LinearVelocity,
    Mass,
    Name,
    NonNegativeAngle,
    NonNegativeLength,
    Number,
    PositiveDuration,
    PositiveLength,
    Rate,
    SpecModel,
)
from harness.language.expectation import Quantity
from harness.language.poses import Direction, Pose, PoseTolerance, Position
from harness.recording.run import Run
from harness.recording.verdict import Measure, Verdict

__all__ = [
    "Angle",
    "AngleBetween",
    "AngularVelocity",
    "At",
    "Count",
    "Direction",
    "Duration",
    "Evidence",
    "Expectation",
    "Flag",
    "Force",
    "Fraction",
    "JointValue",
    "Length",
    "LinearVelocity",
    "Margin",
    "MarginSignal",
    "Mass",
    "Measure",
    "Name",
    "NonNegativeAngle",
    "NonNegativeLength",
    "NotObservable",
    "NotReached",
    "Number",
    "ObjectPredicate",
    "Observations",
    "Part",
    "PictureRequest",
    "Pose",
    "PoseTolerance",
    "Position",
    "PositiveDuration",
    "PositiveLength",
    "Predicate",
    "Quantity",
    "Rate",
    "Run",
    "Scope",
    "SpecModel",
    "TemporalWord",
    "Verdict",
    "Window",
    "all_of",
    "amount",
    "amounts",
    "force_between",
    "frame_poses",
    "measured",
    "object_poses",
    "present",
]


def __getattr__(name: str) -> Any:
    """Import the class of a built-in expectation, such as `Always`."""
    return built_in_class("expectation", name)
