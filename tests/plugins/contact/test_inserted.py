"""inserted, and holes: a peg in its hole, next to it, on its rim, and held by a weld."""

from dataclasses import replace

import numpy as np
import pytest

import harness
from harness.judging.judge import judge
from harness.judging.placed import PlacedExpectation
from harness.plugins.contact.expectations.inserted import Inserted
from harness.recording.run import AttachmentRecord
from tests.judging.test_looks_back import from_sample

SCENARIO = """
scenario: pegs
robot: open_manipulator_x
objects:
  - name: block
    static: true
    box: {{size: [80 mm, 80 mm, 50 mm], hole: {hole}}}
    pose: {{xyz: [0.5, 0.1, 0.025], rpy: [0, 0, {turn} deg]}}
  - {{name: peg, {peg}, pose: {{xyz: {at}}}}}
steps:
  - wait: {wait}
expect:
  - inserted: {{peg: peg, hole: block, depth: {depth}}}
"""
ROUND = "{diameter: 20.2 mm, depth: 40 mm}"
PEG = "cylinder: {radius: 10 mm, length: 80 mm}"
ABOVE = "[0.5, 0.1, 0.0905]"  # its lower end is 0.5 mm above the opening


def run_of(folder, hole=ROUND, peg=PEG, at=ABOVE, depth="39 mm", turn=0, wait=0.35):
    file = folder / "pegs.scenario.yaml"
    words = {"hole": hole, "peg": peg, "at": at, "depth": depth, "turn": turn, "wait": wait}
    file.write_text(SCENARIO.format(**words), encoding="utf-8")
    return harness.run(file)


@pytest.fixture(scope="module")
def inserted(tmp_path_factory):
    """A run in which a peg falls into its hole, which is 0.2 mm wider."""
    result = run_of(tmp_path_factory.mktemp("inserted"))
    assert result, str(result)
    return result


def test_the_margin_is_the_depth_beyond_the_required_one(inserted):
    verdict = inserted.case.verdicts[0]
    assert verdict.unit == "m"
    assert verdict.margin == pytest.approx(0.001, abs=3e-4)
    peg = inserted.run.signals.object_poses["peg"][-1]
    assert np.abs(peg[:2] - [0.5, 0.1]).max() < 1.5e-4, "the hole's clearance keeps it"


@pytest.mark.nightly(but=[1])
@pytest.mark.parametrize(
    ("hole", "peg", "turn"),
    [
        (ROUND, "cylinder: {radius: 10.05 mm, length: 80 mm}", 20),
        ("{diameter: 20.2 mm, depth: 40 mm, sides: 64}", PEG, 0),
        ("{size: [20.2 mm, 30.2 mm], depth: 40 mm}", "box: {size: [20 mm, 30 mm, 80 mm]}", 0),
    ],
)
def test_a_hole_stays_a_hole_down_to_a_tenth_of_a_millimetre(tmp_path, hole, peg, turn):
    result = run_of(tmp_path, hole, peg, turn=turn)
    assert result, str(result)


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(
    ("hole", "peg", "length"),
    [
        (ROUND, "cylinder: {radius: 10 mm, length: 15 mm}", 15),
        ("{size: [20.4 mm, 20.4 mm], depth: 40 mm}", "box: {size: [20 mm, 20 mm, 20 mm]}", 20),
        ("{size: [20.4 mm, 30.4 mm], depth: 40 mm}", "box: {size: [20 mm, 30 mm, 30 mm]}", 30),
        ("{size: [30.4 mm, 30.4 mm], depth: 40 mm}", "box: {size: [30 mm, 30 mm, 10 mm]}", 10),
    ],
)
def test_a_peg_that_is_no_longer_than_thick_is_in_its_hole(tmp_path, hole, peg, length):
    at = f"[0.5, 0.1, {0.0505 + length / 2000}]"
    result = run_of(tmp_path, hole, f"friction: 0.01, {peg}", at)
    assert result, str(result)
    next_to = run_of(tmp_path, hole, peg, f"[0.56, 0.1, {length / 2000}]", wait=0.1)
    assert "mm from the axis of the hole" in str(next_to)


@pytest.mark.parametrize(
    ("hole", "peg", "at", "said"),
    [
        (ROUND, "cylinder: {radius: 10.15 mm, length: 80 mm}", ABOVE, "deep in the hole"),
        ("{size: [20.2 mm, 20.2 mm]}", "box: {size: [20.3 mm, 20 mm, 80 mm]}", ABOVE, "deep in"),
        (ROUND, PEG, "[0.508, 0.1, 0.0905]", "mm from the axis of the hole"),
        (ROUND, PEG, "[0.56, 0.1, 0.04]", "60.0 mm from the axis of the hole"),
        (ROUND, PEG, "[0.5, 0.1, 0.3]", "deep in the hole"),
    ],
)
def test_a_peg_that_does_not_fit_stands_on_the_rim_or_next_to_it_is_not_in(
    tmp_path, hole, peg, at, said
):
    result = run_of(tmp_path, hole, peg, at, wait=0.15)
    assert result.case.outcome == "failed"
    assert said in str(result)


@pytest.mark.parametrize(
    ("hole", "peg"),
    [
        (ROUND, "mass: 4, cylinder: {radius: 10.16 mm, length: 80 mm}"),
        (
            "{size: [20.2 mm, 30.2 mm]}",
            "mass: 4, friction: 0.1, box: {size: [20.3 mm, 30 mm, 80 mm]}",
        ),
    ],
)
def test_a_peg_that_is_a_tenth_too_thick_is_not_pressed_in_by_its_weight(tmp_path, hole, peg):
    """40 N; walls that give way by a tenth of a millimetre under load would let it in."""
    result = run_of(tmp_path, hole, peg, "[0.5, 0.1, 0.09]", depth="2 mm", wait=0.6)
    assert result.case.outcome == "failed"
    depth = 0.09 - result.run.signals.object_poses["peg"][-1, 2]
    assert depth < 5e-4


def test_a_peg_in_a_weld_passes_with_a_warning(inserted):
    """It may hang in the air above the bottom, and nothing shows that it would stay."""
    record = AttachmentRecord(
        "peg", "link5", 0.0, float("inf"), (0, 0, 0, 1, 0, 0, 0), "peg", welded=(0.0, float("inf"))
    )
    run = replace(inserted.run, attachments=(record,))
    verdict = Inserted(peg="peg", hole="block", depth=0.03).verdict(run, "")
    assert [warning.name for warning in verdict.warnings] == ["held by a weld"]
    released = replace(record, welded=(0.0, 0.1))
    verdict = Inserted(peg="peg", hole="block", depth=0.03).verdict(
        replace(run, attachments=(released,)), ""
    )
    assert not verdict.warnings


@pytest.mark.parametrize("depth", [0.039, 0.05])
def test_a_look_reads_nothing_from_before_the_step(inserted, depth):
    placed = [PlacedExpectation.of(Inserted(peg="peg", hole="block", depth=depth), "", 1)]
    assert placed[0].spec.looks_back() == 0.0
    [whole] = judge(inserted.run, placed)
    [part] = judge(from_sample(inserted.run, 300), placed)
    assert (part.status, part.margin) == (whole.status, whole.margin)


def test_a_peg_that_was_in_its_hole_all_the_time_is_no_insertion(tmp_path):
    result = run_of(tmp_path, at="[0.5, 0.1, 0.0501]", wait=0.1)
    assert "already true at the start" in str(result.case.verdicts[0].warnings)


THROUGH = "{size: [80 mm, 80 mm, 30 mm], hole: {diameter: 20.2 mm, depth: 30 mm}}"


@pytest.mark.nightly(but=["0.06-0.02"])
@pytest.mark.parametrize(
    ("bottom", "engaged"), [(0.078, 0.002), (0.06, 0.02), (0.05, 0.03), (0.03, 0.03)]
)
def test_of_a_peg_that_leaves_the_hole_below_what_is_still_in_it_counts(tmp_path, bottom, engaged):
    """It stands on the ground, and its end is far below the opening in every case."""
    file = tmp_path / "through.scenario.yaml"
    peg = "cylinder: {radius: 10 mm, length: 80 mm}"
    words = {"hole": ROUND, "peg": peg, "at": "[0.5, 0.1, 0.0405]", "depth": "25 mm", "turn": 0}
    text = SCENARIO.format(**words, wait=0.1)
    text = text.replace("{size: [80 mm, 80 mm, 50 mm], hole: " + ROUND + "}", THROUGH)
    file.write_text(text.replace("0.025]", f"{bottom + 0.015}]"), encoding="utf-8")
    verdict = harness.run(file).case.verdicts[0]
    assert (verdict.status == "passed") == (engaged >= 0.025)
    if engaged < 0.025:
        assert verdict.margin == pytest.approx(engaged - 0.025, abs=5e-4)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ({"hole": "{diameter: 60 mm}"}, "the hole leaves no wall along x"),
        ({"hole": "{diameter: 20 mm, at: [30 mm, 0]}"}, "no wall along x"),
        ({"hole": "{size: [20 mm, 80 mm]}"}, "no wall along y"),
        ({"hole": "{diameter: 20 mm, size: [20 mm, 20 mm]}"}, "`diameter` and `size`"),
        ({"hole": "{diameter: 20 mm, sides: 30}"}, "multiple of 4"),
        ({"hole": "{size: [20 mm, 20 mm], sides: 32}"}, "leave out `sides`"),
        ({"depth": "41 mm"}, "the hole is 40.0 mm deep"),
        ({"peg": "box: {size: [0.1, 0.1, 0.1], hole: {diameter: 2 cm}}"}, "static: true"),
    ],
)
def test_bad_input_is_a_located_error(tmp_path, words, said):
    result = run_of(tmp_path, **words)
    assert result.case.outcome == "invalid"
    assert said in str(result)
    assert "pegs.scenario.yaml:" in str(result)


def test_an_object_without_a_hole_is_a_located_error(tmp_path):
    file = tmp_path / "pegs.scenario.yaml"
    text = SCENARIO.format(hole=ROUND, peg=PEG, at=ABOVE, depth="1 mm", turn=0, wait=0.1)
    file.write_text(text.replace("hole: block", "hole: peg"), encoding="utf-8")
    assert "'peg' has no hole" in str(harness.run(file))
