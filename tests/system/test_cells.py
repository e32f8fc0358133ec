"""The scenarios with belts, suction cups and several arms pass as they stand."""

import pytest

from harness.core.resources import data_folder
from tests.running import run_case

CELLS = data_folder("scenarios") / "cells"


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["belt_sorter", "suction_onto_a_pallet", "two_arms_at_once"])
def test_the_scenario_passes(name):
    result = run_case(CELLS / f"{name}.scenario.yaml")
    assert result.outcome == "passed", (result.problems, result.steps, result.verdicts)
