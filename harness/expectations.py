"""Expectations of a scenario file, one per module, and what a package needs to add its own.

A module here has the name of its expectation in a file (`in_` for `in`). The registry finds the
modules by their names, and imports one when a file uses its word. A package of its own names its
modules in the entry-point group `harness.plugins`:

    from harness.expectations import Length, Margin, Predicate, Window


    class TcpHeight(Predicate):
        \"\"\"The TCP is at least this high above the world's origin.\"\"\"

        at_least: Length

        def signal(self, window: Window) -> Margin:
            return window.tcp_position[:, 2] - self.at_least
"""

from harness.cell.scope import At
from harness.judging.expectation import Expectation, ObjectPredicate, Predicate, TemporalWord
from harness.judging.margins import Evidence, Margin, MarginSignal, Part, all_of, measured
from harness.judging.observations import Observations, PictureRequest
from harness.judging.poses import frame_poses, object_poses
from harness.judging.window import NotObservable, NotReached, Window
from harness.language.base import (
    Angle,
    AngularVelocity,
    Duration,
    Force,
    Fraction,
    JointValue,
    Length,
    LinearVelocity,
    Name,
)
from harness.language.expectation import Quantity

__all__ = [
    "Angle",
    "AngularVelocity",
    "At",
    "Duration",
    "Evidence",
    "Expectation",
    "Force",
    "Fraction",
    "JointValue",
    "Length",
    "LinearVelocity",
    "Margin",
    "MarginSignal",
    "Name",
    "NotObservable",
    "NotReached",
    "ObjectPredicate",
    "Observations",
    "Part",
    "PictureRequest",
    "Predicate",
    "Quantity",
    "TemporalWord",
    "Window",
    "all_of",
    "frame_poses",
    "measured",
    "object_poses",
]
