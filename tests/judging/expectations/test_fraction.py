"""fraction: how much of their Cartesian paths the steps followed, as they reported it."""

import numpy as np
import pytest

from harness.plugins.paths.expectations.fraction import FractionCheck
from harness.plugins.paths.expectations.tcp_path import TcpPath
from harness.reporting.margins import allowance_used, margin_share, used_allowance
from tests.judging import evidence_runs as shared
from tests.judging.evidence import Evidence, Three
from tests.judging.synthetic_run import followed, heights, make_run, step, verdict

LINE = {"start": {"xyz": [0, 0, 0.3]}, "end": {"xyz": [0, 0, 0.5]}}


def along_z(offset=0.0, start=0.3, end=0.5):
    tcp = heights(np.linspace(start, end, 200))
    tcp[100, 0] = offset
    return make_run(tcp_pose=tcp)


def test_the_least_share_of_the_cartesian_paths_of_a_window_counts():
    run = make_run(
        steps=(
            step("weld", 0, 50, "cartesian_path", result=followed(1.0)),
            step("back", 50, 100, "cartesian_path", result=followed(0.74)),
            step("wait", 100, 200, "wait"),
        )
    )
    assert verdict(run, FractionCheck(), "weld").margin == pytest.approx(0.0)
    answer = verdict(run, FractionCheck(at_least=0.75))
    assert (answer.status, answer.unit, answer.margin) == ("failed", "1", pytest.approx(-0.01))
    assert answer.reason.startswith("74.0 % of the path of back followed, 75.0 % required")
    assert verdict(run, FractionCheck(at_least=0.7)).status == "passed"
    assert verdict(run, FractionCheck(), "wait").status == "not reached"
    broken = make_run(steps=(step("weld", 0, 50, "cartesian_path", result=followed(None)),))
    assert verdict(broken, FractionCheck(at_least=0.1)).status == "not reached"


def test_a_share_that_is_complete_uses_none_of_its_allowance():
    spec = TcpPath(line=LINE, max_deviation=0.002)
    answer = verdict(along_z(), spec)
    used = {measure.name: allowance_used(measure) for measure in answer.measures}
    assert used["share travelled forwards"] == pytest.approx(0.0, abs=1e-9)
    assert margin_share(answer) == pytest.approx(1.0)
    half = verdict(along_z(end=0.495), TcpPath(line=LINE, max_deviation=0.99))
    assert used_allowance(half) == pytest.approx(0.5, abs=1e-6)
    assert margin_share(half) == pytest.approx(0.5, abs=1e-6)


EVIDENCE = Evidence(
    three_runs=(
        Three(
            FractionCheck(at_least=0.8),
            shared.path_run(0.8),
            shared.path_run(0.79),
            -0.01,
            "1",
            make_run(),
        ),
    ),
    mutation_cases=((FractionCheck(at_least=0.8), make_run(steps=shared.REPORTS), ""),),
    picture=(("paths", "{at_least: 0.4}"), ("paths", "{at_least: 0.5}")),
)
