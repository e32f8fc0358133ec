"""How motions are planned: PlanRequestParameters' words."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Field

from harness.language.base import (
    Count,
    Duration,
    JointJerk,
    Name,
    NonNegativeLength,
    Number,
    Share,
    SpecModel,
    refuse_percent,
)
from harness.language.plugin_field import PluginName

Scaling = Annotated[Share, BeforeValidator(refuse_percent), Field(ge=0.001, le=1)]
"""Share of a limit; below a thousandth a motion would take hours."""

Pipeline = Annotated[
    Name,
    PluginName(
        "planner",
        refused={
            "pilz_industrial_motion_planner": (
                "Pilz's planners are steps here",
                "write `ptp:`, `lin:` or `circ:` instead of `move_to:`",
            ),
        },
    ),
]


class Planning(SpecModel):
    """Planning parameters; what is not given comes from the scenario, then from the defaults."""

    pipeline: Pipeline | None = Field(
        default=None,
        description="The planning pipeline of free motions: `ompl`, the default, or a plug-in, "
        "whose paths are verified and timed like those of `ompl`; `harness list pipelines` has "
        "their names. Pilz's planners are the steps `ptp`, `lin`, `circ`.",
    )
    planner_id: Name | None = Field(
        default=None,
        description="A planner of the pipeline. The default of `ompl` is `auto`: a direct joint "
        "motion, else `BalancedConnect`, else `RRTConnect`; `harness list planners` has the "
        "others.",
    )
    planning_time: Annotated[Duration, Field(gt=0)] | None = Field(
        default=None,
        description="A time budget that is converted to state checks at a fixed rate; it is never "
        "a wall clock.",
    )
    max_state_checks: Annotated[Count, Field(ge=1, le=10_000_000)] | None = Field(
        default=None,
        description="The budget of a search: states checked for collision and path constraints; "
        "the default is 2000000. Planners that improve their path (`RRTstar`, "
        "`PRMstar`, `BITstar` ...) do so for a fiftieth of it.",
    )
    planning_attempts: Annotated[Count, Field(ge=1, le=100)] | None = Field(
        default=None,
        description="The largest number of searches, each with its own seed, until one succeeds; "
        "the default is 1.",
    )
    max_velocity_scaling_factor: Scaling | None = Field(
        default=None,
        description="The share of the joints' velocity limits that a motion may use; the default "
        "is 0.3.",
    )
    max_acceleration_scaling_factor: Scaling | None = Field(
        default=None,
        description="The share of the joints' acceleration limits that a motion may use; the "
        "default is 0.3.",
    )
    max_jerk: Annotated[JointJerk, Field(gt=0)] | None = Field(
        default=None,
        description="The largest jerk of every joint; by default the jerk is not limited.",
    )
    padding: NonNegativeLength | None = Field(
        default=None,
        description="The distance kept between every object and the robot with what it holds, and "
        "between two arms [m]; the default is 2 mm.",
    )
    seed: Annotated[Count, Field(ge=0, le=2**31 - 1)] | None = Field(
        default=None,
        description="The seed of the planners in place of the scenario's `seed`; of the samples of "
        "`randomize` too, which have seeds of their own otherwise.",
    )
    parameters: dict[Name, Number] | None = Field(
        default=None,
        description="Parameters of the planner; those of `ompl` have OMPL's names: `range`, "
        "`goal_bias`, `max_nearest_neighbors`, `samples_per_batch` ...",
    )
