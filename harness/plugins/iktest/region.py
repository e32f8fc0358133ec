"""Where misses are: unlike mistakes of a function show in unlike regions of its targets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.spatial import pitch_of
from harness.core.types import BoolArray, FloatArray
from harness.plugins.iktest.chain import Chain
from harness.plugins.iktest.offset import number_of_places
from harness.plugins.iktest.strategies.poses import Target

LEAST_PLACES = 3  # places of right answers, and of misses in each region: fewer may be an accident


@dataclass(frozen=True)
class Region:
    """Targets and answers of which one coordinate is beyond a bound.

    Attributes:
        coordinate: Its place in `coordinates`.
        name: The name of the coordinate in reports.
        bound: The outermost value of right answers, exclusive [m or rad].
        is_above: Whether the region is above the bound, or below.
    """

    coordinate: int
    name: str
    bound: float
    is_above: bool

    def contains(self, values: FloatArray) -> BoolArray:
        """Which coordinates are in the region, shape (..., count)."""
        value = values[..., self.coordinate]
        return value > self.bound if self.is_above else value < self.bound

    def text(self) -> str:
        """The region in words."""
        side = "above" if self.is_above else "below"
        return f"where no answer is right: {self.name} is {side} {self.bound:.3g}"


def coordinates(chain: Chain, target: Target, answer: FloatArray) -> FloatArray:
    """What regions are bounded by: of the target [m, rad], and the answer's joint positions."""
    place = target.pose.translation
    away = place - chain.farthest()[0]
    distances = [np.hypot(away[0], away[1]), np.linalg.norm(away), np.linalg.norm(place)]
    heading, pitch = np.arctan2(away[1], away[0]), pitch_of(target.pose.rotation)
    return np.array([*place, *distances, heading, pitch, *answer])


def coordinate_names(chain: Chain) -> tuple[str, ...]:
    """The names of `coordinates`."""
    distances = (f"the distance from the {each}" for each in ("first axis", "shoulder", "origin"))
    return ("x", "y", "z", *distances, "the heading", "the pitch", *chain.joint_names)


def separate_regions(
    chain: Chain, pairs: Sequence[tuple[Target, FloatArray]], is_wrong: BoolArray
) -> tuple[Region, ...]:
    """The regions of several mistakes, first those that hold home, then those of most misses.

    One mistake shows on one side of a bound, or in a region of another shape. Several are known
    only if each has a coordinate of its own beyond whose bound no answer is right, and if together
    these regions hold all misses. A miss in several regions counts to the first: the smallest
    example of each other one is outside of the region that holds home.

    Args:
        pairs: Targets and the answers to them.
        is_wrong: The answers that miss their targets, shape (N,).

    Returns:
        The regions; none where the misses may have one cause.
    """
    places = [target.pose.translation for target, _ in pairs]
    if _count(places, ~is_wrong) < LEAST_PLACES:
        return ()
    values = np.array([coordinates(chain, *each) for each in pairs])
    right, wrong = values[~is_wrong], values[is_wrong]
    candidates = [
        Region(index, name, float(bound), is_above)
        for index, name in enumerate(coordinate_names(chain))
        for bound, is_above in ((right[:, index].max(), True), (right[:, index].min(), False))
    ]
    wrong_places = [place for place, miss in zip(places, is_wrong, strict=True) if miss]
    found: list[Region] = []
    left = np.ones(len(wrong), dtype=bool)
    while left.any() and len(found) < values.shape[1]:
        used = {each.coordinate for each in found}
        free = [each for each in candidates if each.coordinate not in used]
        best = max(free, key=lambda each: int((left & each.contains(wrong)).sum()))
        added = left & best.contains(wrong)
        if _count(wrong_places, added) < LEAST_PLACES:
            return ()
        found.append(best)
        left &= ~added
    if left.any() or len(found) == 1:
        return ()
    start = coordinates(chain, Target(chain.link_pose(chain.home)), chain.home)
    return tuple(sorted(found, key=lambda each: not each.contains(start)))


def _count(places: Sequence[FloatArray], chosen: BoolArray) -> int:
    """How many of the chosen places lie apart."""
    return number_of_places([place for place, one in zip(places, chosen, strict=True) if one])
