"""The planning group of all arms of a robot with several."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from harness.robot.description import ALL_ARMS, NamedState
from harness.robot.srdf.srdf import Srdf, SrdfGroup


def with_group_of_all(srdf: Srdf, arms: Sequence[str]) -> Srdf:
    """The SRDF with a group of all arms, and the states that each of them has."""
    if ALL_ARMS in {group.name for group in srdf.groups}:
        return srdf
    states = {(state.group, state.name): state.positions for state in srdf.states}
    shared = tuple(
        NamedState(name, ALL_ARMS, {k: v for arm in arms for k, v in states[arm, name].items()})
        for group, name in states
        if group == arms[0] and all((arm, name) in states for arm in arms)
    )
    group = SrdfGroup(ALL_ARMS, subgroups=tuple(arms))
    return replace(srdf, groups=(*srdf.groups, group), states=(*srdf.states, *shared))
