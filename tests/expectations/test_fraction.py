"""fraction: how much of their Cartesian paths the steps followed, as they reported it."""

import pytest

from harness.expectations.fraction import FractionCheck
from tests.assertions.synthetic_run import make_run, step, verdict


def test_the_least_share_of_the_cartesian_paths_of_a_window_counts():
    run = make_run(
        steps=(
            step("weld", 0, 50, "cartesian_path", result={"fraction": 1.0}),
            step("back", 50, 100, "cartesian_path", result={"fraction": 0.74}),
            step("wait", 100, 200, "wait"),
        )
    )
    assert verdict(run, FractionCheck(), "weld").margin == pytest.approx(0.0)
    answer = verdict(run, FractionCheck(at_least=0.75))
    assert (answer.status, answer.unit, answer.margin) == ("failed", "1", pytest.approx(-0.01))
    assert answer.reason.startswith("74.0 % of the path of back followed, 75.0 % asked for")
    assert verdict(run, FractionCheck(at_least=0.7)).status == "passed"
    assert verdict(run, FractionCheck(), "wait").status == "not reached"
    broken = make_run(steps=(step("weld", 0, 50, "cartesian_path", result={"fraction": None}),))
    assert verdict(broken, FractionCheck(at_least=0)).status == "not reached"
