"""Every property finds the mistake that breaks it, shrunk; none finds one in what is right."""

# ruff: noqa: ARG001, ARG005

import itertools
import json
import re

import numpy as np
import pytest

from harness.core.errors import RobotError
from harness.plugins.iktest import IkTest, check_ik, run_ik_test
from harness.plugins.iktest.contract import UnusableSolver
from harness.plugins.iktest.strategies import load_chain
from harness.plugins.iktest.text import report_lines
from harness.robot.robot_source import RobotSource
from tests.plugins.iktest.arms import OM, correct

HOME = load_chain(OM).home
HOME_TIP = load_chain(OM).link_pose(HOME).translation


def found(function, **options):
    """Findings by property, of a quick test on the OpenMANIPULATOR-X."""
    report = run_ik_test(IkTest(function, OM, examples=40, **options))
    return {finding.property: finding for finding in report.findings}


def moved(target):
    """How many joints of a smallest example are not at home."""
    return np.count_nonzero(np.abs(target.joint_positions - HOME) > 1e-9)


@pytest.mark.nightly(but=["10"])
@pytest.mark.parametrize("examples", [10, 40])
def test_a_correct_solver_passes_with_everything_it_claims(examples):
    report = check_ik(correct, OM, branches=True, examples=examples)
    assert report.has_passed
    assert [each.name for each in report.properties] == [
        "reaches", "answers", "limits", "refuses", "anywhere", "continuity", "determinism",
        "branches",
    ]  # fmt: skip
    assert all(each.tried >= examples // 5 for each in report.properties)
    assert report.speed.calls == examples


@pytest.mark.nightly
def test_a_tool_of_another_length_is_reported_in_the_links_axes():
    def longer(x, y, z, pitch):
        heading = np.arctan2(y, x - 0.012)
        ahead, up = -0.01 * np.cos(pitch), 0.01 * np.sin(pitch)
        return correct(x + ahead * np.cos(heading), y + ahead * np.sin(heading), z + up, pitch)[:1]

    finding = found(longer)["reaches"]
    assert finding.kind == "is off by (-10.0, 0.0, 0.0) mm in the link's own axes, at every target"
    assert np.array_equal(finding.target.joint_positions, HOME)


@pytest.mark.nightly
def test_an_answer_beyond_a_limit_is_found_with_its_joint():
    def ik(x, y, z, pitch):
        return [[q1 + 2 * np.pi * (q1 < -1), *rest] for q1, *rest in correct(x, y, z, pitch)]

    finding = found(ik)["limits"]
    assert finding.kind == "leaves the joint limits"
    assert "joint1 at" in finding.detail
    assert moved(finding.target) <= 1


@pytest.mark.nightly
def test_a_refusal_within_reach_is_found_at_its_threshold():
    def ik(x, y, z, pitch):
        return None if y > 0.1 else correct(x, y, z, pitch)

    finding = found(ik)["answers"]
    assert finding.kind == "refuses a target within reach"
    assert moved(finding.target) == 1
    assert 0.1 < finding.target.pose.translation[1] < 0.12


@pytest.mark.nightly
def test_arithmetic_that_breaks_and_nan_are_found_where_they_show():
    def nan(x, y, z, pitch):
        return correct(x, y, z, pitch) if np.hypot(x, y) < 0.3 else [np.arccos(2 + x * x)] * 4

    finding = found(nan)["answers"]
    assert finding.kind == "answers with NaN or infinity"
    assert json.dumps(finding.facts(), allow_nan=False)

    def divides(x, y, z, pitch):
        return [1.0 / 0.0] * 4 if np.hypot(x, y) > 0.3 else correct(x, y, z, pitch)

    finding = found(divides)["answers"]
    assert finding.kind.startswith("raises ZeroDivisionError at test_kit.py:")


@pytest.mark.nightly
def test_the_nearest_point_is_no_answer_to_a_target_out_of_reach():
    def ik(x, y, z, pitch):
        return correct(x, y, z, pitch) or [0.0, 0.0, 0.0, 0.0]

    finding = found(ik)["refuses"]
    assert finding.kind == "answers a target out of reach"
    assert "position off by" in finding.detail


@pytest.mark.nightly
def test_another_branch_in_mid_line_is_a_jump_and_a_steep_motion_is_none():
    def ik(x, y, z, pitch):
        ways = correct(x, y, z, pitch)
        return ways[int(1000 * z) % 2 % len(ways)] if ways else None

    finding = found(ik)["continuity"]
    assert finding.kind == "jumps along a straight line"
    assert "while the target moves by" in finding.detail
    assert "continuity" not in found(correct)


@pytest.mark.nightly
def test_an_answer_that_depends_on_the_call_before_is_found():
    counter = itertools.count()

    def ik(x, y, z, pitch):
        return [[*rest, q4 + 1e-12 * next(counter)] for *rest, q4 in correct(x, y, z, pitch)]

    assert found(ik)["determinism"].kind == "answers differently when called again"


@pytest.mark.nightly
def test_a_way_left_out_is_found_only_where_all_are_claimed():
    def ik(x, y, z, pitch):
        return correct(x, y, z, pitch)[:1]

    assert "branches" not in found(ik)
    finding = found(ik, branches=True)["branches"]
    assert finding.kind == "leaves out a way to reach the target"
    assert "1 answers, none of them" in finding.detail


@pytest.mark.nightly
def test_the_same_seed_finds_the_same_and_another_draws_others():
    def run(seed):
        calls = []

        def ik(x, y, z, pitch):
            calls.append((x, y, z, pitch))
            return [0.1, 0.2, 0.3, 0.4]

        facts = run_ik_test(IkTest(ik, OM, examples=20, seed=seed)).facts()
        del facts["wall_times"]
        return calls, facts

    first, again, (other, _) = run(3), run(3), run(4)
    assert first == again
    assert first[0] != other


@pytest.mark.nightly
def test_the_assertion_of_a_test_reports_findings_in_numbers():
    def ik(x, y, z, pitch):
        return correct(x, y, z - 0.017, pitch)

    with pytest.raises(AssertionError) as caught:
        check_ik(ik, OM, examples=20)
    text = str(caught.value)
    x, y, z = (round(float(value), 9) + 0.0 for value in HOME_TIP)
    assert "is off by (0.0, 0.0, -17.0) mm in the world's axes, at every target" in text
    assert f"call        ik(x={x!r}, y={y!r}, z={z!r}, pitch=0.0)" in text
    assert "reached by  home" in text


@pytest.mark.nightly
def test_pictures_and_numbers_go_into_the_report_folder(tmp_path):
    def ik(x, y, z, pitch):
        return [0.0, 0.0, 0.0, 0.0]

    (tmp_path / "finding-9-old.jpg").write_bytes(b"")
    report = run_ik_test(IkTest(ik, OM, examples=10, report_dir=tmp_path))
    pictures = sorted(path.name for path in tmp_path.glob("*.jpg"))
    assert pictures == sorted(finding.picture for finding in report.findings)
    facts = json.loads((tmp_path / "ik_test.json").read_text())
    assert facts["outcome"] == "failed"
    assert str(tmp_path / pictures[0]) in "\n".join(report_lines(report, tmp_path))


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("function", "unobserved"),
    [
        (lambda x, y, z, pitch: 1 / 0, {"reaches", "answers", "limits", "continuity"}),
        (lambda x, y, z, pitch: None, {"reaches", "limits", "continuity"}),
    ],
)
def test_a_property_of_answers_is_not_kept_where_nothing_is_answered(function, unobserved):
    report = run_ik_test(IkTest(function, OM, examples=10))
    lines = "\n".join(report_lines(report))
    for each in unobserved - {"answers"}:
        assert re.search(rf"(?m)^  {each} +NOT OBSERVED", lines)
    kept = {each.name for each in report.properties if each.observed and not each.flawed}
    assert not kept & unobserved


@pytest.mark.nightly
def test_what_is_refused_half_of_the_time_is_reported_as_observed_in_the_other_half():
    report = run_ik_test(
        IkTest(lambda x, y, z, pitch: correct(x, y, z, pitch) if y > 0 else None, OM, examples=40)
    )
    [limits] = [each for each in report.properties if each.name == "limits"]
    assert 0 < limits.observed < limits.tried == 40
    assert f"ok, {limits.observed} of 40 observed" in "\n".join(report_lines(report))


def test_what_cannot_be_tested_is_refused():
    with pytest.raises(
        UnusableSolver, match=r"<lambda> returned 3 numbers; it must return 4 joint pos"
    ):
        run_ik_test(IkTest(lambda x, y, z: [1, 2, 3], OM))
    with pytest.raises(UnusableSolver, match="position is 3 numbers and the arm has 4 joints"):
        run_ik_test(IkTest(lambda x, y, z: None, OM, branches=True))
    with pytest.raises(RobotError, match="no link 'hand'; links: "):
        run_ik_test(IkTest(correct, RobotSource(OM), link="hand"))
