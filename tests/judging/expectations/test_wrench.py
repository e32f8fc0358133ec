"""wrench: what a sensor of force and torque reads stays within bounds."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.wrench_sensor import WrenchSensor
from harness.plugins.contact.expectations.wrench import Wrench
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Free, Three
from tests.judging.synthetic_run import ROBOT, make_run, verdict

SENSED = replace(ROBOT, wrench_sensors={"wrist": WrenchSensor("wrist", "palm")})
ALONG_Z = {"xyz": [0, 0, 1], "frame": "wrist"}


def read(early, late=None):
    """A run whose sensor reads a wrench early, and another one late."""
    rows = np.tile(np.array(early, dtype=float), (shared.N, 1))
    if late is not None:
        rows[100:] = late
    return make_run(robot=SENSED, steps=shared.LATE, wrenches={"wrist": rows})


def nearest_at_once(wrench, change):
    """A run whose sensor reads a wrench at one sample, and more or less of it at others."""
    share = 1 + change * np.abs(np.arange(shared.N) - 150)
    return make_run(robot=SENSED, wrenches={"wrist": np.outer(share, wrench)})


EVIDENCE = Evidence(
    three_runs=(
        Three(
            Wrench(below=20, force_window=0),
            nearest_at_once([0, 6, 8, 0, 0, 0], -0.001),
            nearest_at_once([0, 0, 20.1, 0, 0, 0], -0.001),
            -0.1,
            "N",
        ),
        Three(
            Wrench(torque_above=2, direction=ALONG_Z, force_window=0),
            nearest_at_once([0, 0, 0, 0, 0, 3], 0.001),
            nearest_at_once([0, 0, 0, 9, 0, 1.9], 0.001),
            -0.1,
            "N*m",
        ),
    ),
    mutation_cases=(
        (
            Wrench.model_validate(
                {
                    "above": 10,
                    "below": 20,
                    "torque_above": 1,
                    "torque_below": 2,
                    "direction": ALONG_Z,
                    "force_window": 0,
                }
            ),
            read([0, 0, 0, 0, 0, 0], [1, 2, 15, 0.1, 0.2, 1.5]),
            "late",
        ),
    ),
    free_shifts=(
        Free(
            "components across the direction",
            "wrench",
            "wrenches",
            "+-x +-y +-force_x +-force_y",
        ),
    ),
)


def test_a_magnitude_is_that_of_three_components_and_a_component_has_a_sign():
    run = read([2, -3, -6, 0, 0, 0])
    assert verdict(run, Wrench(below=20)).measures[0].value == pytest.approx(7)
    along = verdict(run, Wrench.model_validate({"below": 0, "direction": ALONG_Z}))
    assert (along.status, along.measures[0].value) == ("passed", pytest.approx(-6))


def test_a_sensor_that_was_not_recorded_is_not_observable():
    run = make_run(robot=SENSED)
    assert verdict(run, Wrench(below=20)).status == "not observable"
