"""Random samples whose objects overlap at the start: counted, or drawn again."""

import pytest

from tests.commands import harness
from tests.suite.test_suite_run import results

POST = """\
scenario: A cube next to a post
robot: open_manipulator_x
objects:
  - {name: post, box: {size: [6 cm, 6 cm, 20 cm]}, static: true, pose: {xyz: [0.5, 0, 0.1]}}
  - {name: cube, box: {size: [4 cm, 4 cm, 4 cm]}, pose: {xyz: ["${x}", 0, 0.02]}}
params: {x: 0.6}
seed: 3
steps: [{wait: 0.01}]
randomize: {x: {uniform: [0.42, 0.58]}}
samples: 4
"""
REDRAWN = f"{POST}redraw_overlaps: true\n"
FREE = 0.05 - 1e-4  # [m] between the middles of post and cube


@pytest.fixture
def file(tmp_path):
    def write(text):
        path = tmp_path / "post.scenario.yaml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


def places(document):
    return [float(case["values"]["x"]) for case in document["cases"]]


@pytest.mark.nightly
def test_samples_that_overlap_are_counted(file, tmp_path):
    reported = results(file(POST), "--no-report", cwd=tmp_path)
    overlapping = [abs(x - 0.5) < FREE for x in places(reported)]
    assert [case["overlap"] > 0 for case in reported["cases"]] == overlapping
    assert any(overlapping)
    [rate] = reported["rates"]
    assert (rate["rate"]["overlapping"], rate["rate"]["redraws"]) == (sum(overlapping), 0)


@pytest.mark.nightly
def test_samples_that_overlap_are_drawn_again_and_counted(file, tmp_path):
    path = file(REDRAWN)
    reported = results(path, "--no-report", cwd=tmp_path)
    assert all(abs(x - 0.5) >= FREE for x in places(reported))
    assert all(case["overlap"] == 0 for case in reported["cases"])
    redraws = [case["redraws"] for case in reported["cases"]]
    rate = reported["rates"][0]["rate"]
    assert (rate["overlapping"], rate["redraws"]) == (0, sum(redraws))
    assert rate["redrawn"] == sum(count > 0 for count in redraws) > 0
    assert [case["digest"] for case in reported["cases"]] == [
        case["digest"] for case in results(path, "--no-report", cwd=tmp_path)["cases"]
    ]


@pytest.mark.nightly
def test_a_sample_alone_is_the_one_that_it_is_among_all(file, tmp_path):
    path = file(REDRAWN)
    among = {case["case"]: case for case in results(path, "--no-report", cwd=tmp_path)["cases"]}
    [alone] = results(path, "--no-report", "--case", "sample1", cwd=tmp_path)["cases"]
    for key in ("digest", "values", "redraws"):
        assert alone[key] == among["sample1"][key]


@pytest.mark.nightly
def test_samples_that_do_not_overlap_are_those_without_the_option(file, tmp_path):
    apart = POST.replace("[0.42, 0.58]", "[0.6, 0.7]")
    plain = results(file(apart), "--no-report", cwd=tmp_path)
    again = results(file(f"{apart}redraw_overlaps: true\n"), "--no-report", cwd=tmp_path)
    assert [case["digest"] for case in plain["cases"]] == [c["digest"] for c in again["cases"]]
    assert all(case["redraws"] == 0 for case in again["cases"])


@pytest.mark.nightly
def test_where_every_draw_overlaps_the_sample_is_invalid_and_names_the_pair(file, tmp_path):
    text = REDRAWN.replace("[0.42, 0.58]", "[0.49, 0.51]").replace("samples: 4", "samples: 1")
    done = harness("run", file(text), "--no-report", cwd=tmp_path)
    assert done.returncode == 2
    assert "objects overlap in each of 100 draws; in the last one" in done.stdout
    assert "post.scenario.yaml:11" in done.stdout


@pytest.mark.parametrize("more", ["samples: 4", "parametrize: {params.x: [0.1, 0.2]}"])
def test_redrawing_without_random_values_is_refused(file, tmp_path, more):
    lines = [line for line in REDRAWN.splitlines() if not line.startswith(("rand", "sampl"))]
    text = "\n".join([*lines, more, ""])
    done = harness("check", file(text), cwd=tmp_path)
    assert done.returncode == 2
    assert "add `randomize`" in done.stdout
