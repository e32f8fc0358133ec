"""Objects inside something at the start: reported at `check`, in the run, by the verdict."""

import re

import pytest

from harness.recording.read_run import read_run
from harness.session.check import check_file
from tests.running import run_case

CUBE = "box: {size: [10 cm, 10 cm, 10 cm]}, mass: 1"
SCENES = {
    "two cubes": (
        f"{{name: b, {CUBE}, pose: {{xyz: [0.8, 0.52, 0.07]}}}}", ("b", "a"), 0.08,
    ),
    "a cube in the floor": (
        f"{{name: b, {CUBE}, pose: {{xyz: [0.8, -0.5, 0.03]}}}}", ("b", "ground_plane"), 0.02,
    ),
    "a static post in a cube": (
        "{name: b, cylinder: {radius: 2 cm, length: 1 m}, static: true,"
        " pose: {xyz: [0.8, 0.56, 0.5]}}", ("b", "a"), 0.01,
    ),
    "a static block in the robot": (
        "{name: b, box: {size: [10 cm, 10 cm, 30 cm]}, static: true, pose: {xyz: [0, 0, 0.28]}}",
        ("b", "shoulder_link"), None,
    ),
}  # fmt: skip


def scene(folder, obj, rest=""):
    path = folder / "test.scenario.yaml"
    path.write_text(
        f"scenario: overlaps\nrobot: ur3e\nobjects:\n"
        f"  - {{name: a, {CUBE}, pose: {{xyz: [0.8, 0.5, 0.05]}}}}\n  - {obj}\n"
        f"steps: [{{wait: 0.02}}]\n{rest}",
        encoding="utf-8",
    )
    return path


def overlaps(run):
    return [finding for finding in run.findings if finding.kind == "overlap"]


@pytest.mark.parametrize("name", SCENES)
def test_an_overlap_is_reported_with_pair_and_depth_at_check_and_in_the_run(tmp_path, name):
    obj, pair, depth = SCENES[name]
    file = scene(tmp_path, obj)
    result = run_case(file, report_dir=tmp_path / "run", stills=False, page=False)
    found = overlaps(read_run(tmp_path / "run").run)
    values = found[0].values
    assert set(values["pair"]) == set(pair)
    if depth is not None:
        assert len(found) == 1
        assert values["depth"] == pytest.approx(depth, abs=1e-6)
    said = f"overlap by {1e3 * values['depth']:.3g} mm"
    notes = [note for note in check_file(file).notes if "overlap" in note]
    assert notes == [note for note in result.notes if "overlap" in note]
    assert said in notes[0]
    assert re.search(r"test\.scenario\.yaml:[45]:5: at the start ", notes[0])
    assert result.overlap == values["depth"]


@pytest.mark.parametrize("height", [0.05, 0.05 - 5e-5, 0.06])
def test_what_rests_or_is_apart_does_not_overlap(tmp_path, height):
    obj = f"{{name: b, {CUBE}, pose: {{xyz: [0.8, -0.5, {height}]}}}}"
    file = scene(tmp_path, obj)
    assert not [note for note in check_file(file).notes if "overlap" in note]
    assert run_case(file).overlap == 0.0


def test_a_collision_by_an_overlap_is_measured_by_its_depth_and_not_by_a_force(tmp_path):
    file = scene(tmp_path, SCENES["a static block in the robot"][0], "expect: [{never: collision}]")
    result = run_case(file, report_dir=tmp_path / "run", stills=False, page=False)
    [verdict] = result.verdicts
    deepest = overlaps(read_run(tmp_path / "run").run)[0].values["depth"]
    assert (verdict.status, verdict.unit) == ("failed", "m")
    assert verdict.margin == pytest.approx(-deepest)
    assert "overlap by" in verdict.reason
    assert " N" not in verdict.reason


@pytest.mark.parametrize(("count", "more"), [(2, ""), (3, "; and 1 more pairs")])
def test_a_collision_by_overlaps_names_two_pairs_and_counts_the_others(tmp_path, count, more):
    block = "box: {size: [2 cm, 2 cm, 2 cm]}, static: true, pose: {xyz: [0, 0, 0.15]}"
    blocks = [f"{{name: b{number}, {block}}}" for number in range(count)]
    result = run_case(scene(tmp_path, "\n  - ".join(blocks), "expect: [{never: collision}]"))
    reason = result.verdicts[0].reason
    assert reason.count("overlap by") == 2
    assert ("more pairs" in reason, more in reason) == (bool(more), True)
