"""`harness search`: a thin failing region is found, and shrunk to its boundary."""

import json
import re
import shlex
import subprocess
import sys

import pytest
import yaml

from harness.cli.main import main

THIN = """\
scenario: A ball that must not be near a point
robot: open_manipulator_x
seed: 3
params: {x: 0.0, y: 0 m, z: 0.5, color: red}
objects:
  - name: ball
    sphere: {radius: 2 cm}
    pose: {xyz: ["${x}", "${y}", "${z}"]}
    static: true
    color: "${color}"
steps:
  - wait: 2 ms
expect:
  - formula: "always (abs(x(ball) - 0.3) + abs(y(ball) + 0.2) + abs(z(ball) - 0.8) > 14 cm)"
randomize:
  x: {uniform: [-0.5, 0.5]}
  y: {uniform: [-50 cm, 50 cm]}
  z: {uniform: [0.4, 1.1]}
  color: {choice: [red, green]}
"""
"""It fails in an octahedron of 4/3 0.14^3 m^3 of 0.7 m^3, which is 0.52 %."""

TWO_KINDS = """\
scenario: Two limits and a nuisance
robot: open_manipulator_x
params: {x: 0.0, y: 0.0, z: 0.5}
objects:
  - {name: ball, sphere: {radius: 2 cm}, pose: {xyz: ["${x}", "${y}", "${z}"]}, static: true}
steps:
  - wait: 2 ms
expect:
  - formula: "always (x(ball) < 0.3)"
  - formula: "always (y(ball) > -0.4)"
randomize:
  x: {uniform: [-0.5, 0.5]}
  y: {normal: {mean: 0, std: 0.2, low: -0.5, high: 0.5}}
  z: {uniform: [0.4, 1.1]}
"""

SAFE = TWO_KINDS.replace("0.3)", "3)").replace("-0.4)", "-4)")


def search(folder, text, *options):
    """The exit code and the document of a search."""
    file = folder / "thin.scenario.yaml"
    file.write_text(text)
    code = main(["search", str(file), "--report-dir", str(folder / "reports"), *options])
    [numbers] = (folder / "reports").rglob("search.json")
    return code, json.loads(numbers.read_text())


def distance_to_boundary(values):
    """How far the shrunk point is from the octahedron, as a share of the smallest range."""
    y = float(str(values["y"]).split()[0]) / 100
    total = abs(values["x"] - 0.3) + abs(y + 0.2) + abs(values["z"] - 0.8)
    return abs(total - 0.14) / 0.7


@pytest.mark.nightly
def test_a_thin_failure_is_found_shrunk_to_its_boundary_and_written_as_a_scenario(tmp_path):
    code, found = search(tmp_path, THIN, "--seed", "2")
    assert code == 1
    assert found["first_failure"] <= 100
    [failure] = found["failures"]
    assert distance_to_boundary(failure["values"]) < 0.02
    assert failure["changed"] == ["x", "y", "z"]  # the colour does not matter
    assert failure["is_same_digest"]
    text = (tmp_path / failure["scenario"]).read_text()
    assert "randomize" not in yaml.safe_load(text)
    assert failure["digest"] in text
    assert list((tmp_path / failure["report"]).rglob("*.jpg"))


def test_the_page_of_a_search_says_what_was_tried_and_each_command_runs(tmp_path, visit):
    _, found = search(tmp_path, TWO_KINDS, "--runs", "12", "--start", "12")
    [page_file] = (tmp_path / "reports").rglob("index.html")
    page = visit(page_file).page
    shrunk = sum(each["shrink_runs"] for each in found["failures"])
    assert page.locator("#tried p:not(.quiet)").all_inner_texts() == [
        "Varied: x (-0.5 to 0.5), y (-0.489 to 0.489), z (0.4 to 1.1).",
        "12 runs, listed below: spread evenly over the ranges.",
        f"{shrunk} more runs found the smallest changes.",
    ]
    order = "[...document.querySelectorAll('main > section')].map((each) => each.id)"
    assert page.evaluate(order)[:2] == ["changes", "tried"]
    change = page.locator(".change").first
    replays = [each.get_attribute("href") for each in change.locator(".replay").all()]
    assert [each.partition("#")[0] for each in replays] == [
        "nominal/report.html", "failure1/report.html",
    ]  # fmt: skip
    assert all(each.endswith("suite=../index.html") for each in replays), "they lead back"
    assert change.locator(".moved > b").count() == 1, "where the value stands in its range"
    both = change.locator("[data-copy]").last.inner_text()
    reports = page_file.parent / "nominal", page_file.parent / "failure1"
    assert shlex.split(both) == ["harness", "compare", *map(str, reports)]
    again = change.locator("[data-copy]").first.inner_text()
    assert again == f"harness run {found['failures'][0]['scenario']}"
    assert change.locator(f"button[aria-label='copy {again}']").is_visible()
    assert main([*again.split()[1:], "--no-report"]) == 1
    assert page.locator("tr.case").count() == 12
    said = page.inner_text("#map output")
    assert said.endswith("shows the row of one without a report; no run of a search has one.")
    failed = page.locator("tr.case[data-outcome=failed]")
    failed.first.locator("summary").click()
    command = failed.first.locator(".command code").inner_text().split()
    assert command[:2] == ["harness", "run"]
    assert main([*command[1:], "--no-report"]) == 1
    passed = page.locator("tr.case[data-outcome=passed]").first
    passed.locator("summary").click()
    assert passed.locator(".command").count() == 0, "no command draws the run of a search again"


@pytest.mark.nightly
def test_every_kind_of_failure_is_shrunk_to_the_parameter_that_causes_it(tmp_path, capsys):
    code, found = search(tmp_path, TWO_KINDS, "--runs", "40", "--start", "8", "-j", "2")
    assert code == 1
    causes = {tuple(each["changed"]): each["values"] for each in found["failures"]}
    assert set(causes) == {("x",), ("y",)}
    assert causes[("x",)]["x"] == pytest.approx(0.3, abs=0.005)
    assert causes[("y",)]["y"] == pytest.approx(-0.4, abs=0.005)
    printed, log = capsys.readouterr()
    assert "searching: " in log, "a search that is not watched on a terminal says what it does"
    assert f"run{found['first_failure']} failed: " in log, "as the page and the last lines call it"
    headings = re.findall(r"FAILED in \d+ runs?: (.*) \(line (\d+)\)", printed)
    assert {*headings} == {
        ("failed: formula always (x(ball) < 0.3)", "9"),
        ("failed: formula always (y(ball) > -0.4)", "10"),
    }
    [page] = (tmp_path / "reports").rglob("index.html")
    shown = re.findall(r"<article.*?</article>", page.read_text(), re.DOTALL)
    changed = [re.search("<code>(.)</code>", each)[1] for each in shown]
    distances = {tuple(each["changed"]): each["distance"] for each in found["failures"]}
    assert changed == sorted(changed, key=lambda path: distances[path,]), "the smallest first"
    whole = page.read_text()
    counts = [int(each) for each in re.findall(r"(\d+) of the \d+ failed runs", whole)]
    failed = int(re.search(r"thin: (\d+) of \d+ runs failed, in 2 steps or expectations", whole)[1])
    assert failed == sum(counts) == int(re.search(r"</i>(\d+) failed</button>", whole)[1])
    assert "(p = " not in whole, "runs that are chosen to fail show no effect by a test"
    for each in shown:
        replays = re.findall('href="(.*?)[#"]', each)
        assert len(replays) == 2, "as the file is, and changed"
        assert all((page.parent / replay).is_file() for replay in replays)


@pytest.mark.nightly
def test_without_a_failure_the_bound_is_stated_and_the_workers_do_not_matter(tmp_path, capsys):
    (tmp_path / "two").mkdir()
    code, found = search(tmp_path, SAFE, "--runs", "12", "--start", "8")
    assert code == 0
    [page] = (tmp_path / "reports").rglob("index.html")
    said = "12 runs, listed below: 8 spread evenly over the ranges and 4 where margins are small."
    assert said in page.read_text()
    assert found["failures"] == []
    assert found["rate"]["high"] == pytest.approx(1 - 0.05 ** (1 / 8))
    said = capsys.readouterr().out
    assert "0 of 8 low-discrepancy samples failed\n" in said
    assert "confidence" not in said
    _, again = search(tmp_path / "two", SAFE, "--runs", "12", "--start", "8", "-j", "2")
    assert {**again, "file": ""} == {**found, "file": ""}


@pytest.mark.nightly
@pytest.mark.parametrize("rate", ["expect_rate: 80 %", "expect_rate: 10 %", ""])
def test_a_search_shows_no_success_rate(tmp_path, capsys, rate):
    search(tmp_path, f"{TWO_KINDS}{rate}\n", "--runs", "8", "--start", "8", "--seed", "1")
    [page] = (tmp_path / "reports").rglob("index.html")
    for text in (page.read_text(), capsys.readouterr().out):
        assert "low-discrepancy samples failed" in text or "no success rate" in text
        assert "confidence" not in text
        assert "would decide it" not in text
        assert "no rate is required" not in text
    assert 'class="rate' not in page.read_text()


@pytest.mark.nightly
def test_the_file_says_how_it_is_searched_and_options_take_precedence(tmp_path):
    text = TWO_KINDS.replace('- formula: "always (y', '- name: south\n    formula: "always (y')
    text = text.replace("0.3)", "0.49)")  # rarely found by chance
    text += "search: {runs: 30, start: 4, seed: 1, batch: 5, minimise: south}\n"
    _, found = search(tmp_path, text)
    assert found["runs"] <= 30
    assert found["rate"]["total"] == 4
    assert [each["changed"] for each in found["failures"]] == [["y"]]
    _, fewer = search(tmp_path, text, "--runs", "3", "--start", "2")
    assert (fewer["runs"], fewer["rate"]["total"]) == (3, 2)


@pytest.mark.parametrize(
    ("section", "message"),
    [
        ("{runz: 3}", "15:10: unknown key `runz`"),
        ("{runs: 0}", "15:16"),
        ("{batch: 1}", "15:17"),
        ("{minimise: south}", "15:20: no expectation has the name 'south'"),
    ],
)
def test_mistakes_in_the_section_have_their_place(tmp_path, capsys, section, message):
    file = tmp_path / "safe.scenario.yaml"
    file.write_text(f"{SAFE}search: {section}\n")
    assert main(["search", str(file), "--report-dir", str(tmp_path / "reports")]) == 2
    assert f"{file}:{message}" in capsys.readouterr().err
    assert not (tmp_path / "reports").exists()


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        (SAFE, ("--minimise", "south"), "no expectation of"),
        (SAFE.split("randomize")[0], (), "nothing varies; give ranges with `randomize:`"),
        (SAFE, ("--case", "small"), "has no case 'small'"),
        (SAFE + "parametrize: {params.x: [0, 1]}\n", (), "has 2 cases; name one of them"),
        (SAFE.replace("wait", "wiat"), (), "wiat"),
    ],
)
def test_what_cannot_be_searched_is_refused(tmp_path, capsys, text, options, message):
    file = tmp_path / "thin.scenario.yaml"
    file.write_text(text)
    code = main(["search", str(file), "--report-dir", str(tmp_path / "reports"), *options])
    assert code == 2
    assert message in capsys.readouterr().err
    assert not list(tmp_path.rglob("search.json"))


@pytest.mark.nightly
def test_starts_with_overlaps_do_not_count_where_the_file_redraws_them(tmp_path, capsys):
    post = (
        "  - {name: post, box: {size: [0.4, 0.9, 0.7]}, pose: {xyz: [0.3, 0, 0.8]}, static: true}\n"
    )
    text = SAFE.replace("steps:", f"{post}redraw_overlaps: true\nsteps:")
    text = text.replace(", static: true}\n  - {n", "}\n  - {n")
    code, found = search(tmp_path, text, "--runs", "8", "--start", "8")
    assert code == 0
    assert found["uncounted"] > 0
    assert found["rate"]["total"] == 8 - found["uncounted"]
    assert f"{found['uncounted']} runs are invalid or begin with an overlap" in (
        capsys.readouterr().out
    )
    everywhere = text.replace("[0.4, 0.9, 0.7]", "[3, 3, 3]")
    file = tmp_path / "thin.scenario.yaml"
    file.write_text(everywhere)
    assert main(["search", str(file), "--runs", "2", "--report-dir", str(tmp_path / "no")]) == 2
    assert "bodies overlap at the start of every sample" in capsys.readouterr().err


@pytest.mark.nightly
def test_a_scenario_that_fails_as_written_needs_no_search(tmp_path, capsys):
    code, found = search(tmp_path, TWO_KINDS.replace("x: 0.0", "x: 0.4"))
    assert code == 1
    assert found["failures"] == []
    assert "the scenario fails unchanged" in capsys.readouterr().out


@pytest.mark.nightly
def test_a_single_parameter_at_a_larger_change_is_preferred_to_two(tmp_path):
    """A sample fails with x + z > 0.5; x alone is enough, further out."""
    text = SAFE.replace("x(ball) < 3", "x(ball) + z(ball) < 0.95")
    code, found = search(tmp_path, text, "--runs", "8", "--start", "8")
    assert code == 1
    [failure] = found["failures"]
    assert failure["changed"] in (["x"], ["z"])
    total = failure["values"]["x"] + failure["values"]["z"]
    assert total == pytest.approx(0.95, abs=0.005)


@pytest.mark.nightly
def test_a_thin_failure_is_found_within_100_runs_in_18_of_20_seeds(tmp_path):
    found = []
    for seed in range(1, 21):
        folder = tmp_path / str(seed)
        folder.mkdir()
        _, document = search(folder, THIN, "--seed", str(seed), "-j", "2")
        if document["failures"]:
            found.append(document)
            [failure] = document["failures"]
            assert distance_to_boundary(failure["values"]) < 0.02
            assert failure["is_same_digest"]
    assert sum(document["first_failure"] <= 100 for document in found) >= 18


@pytest.mark.nightly
def test_an_interrupted_search_goes_on_with_resume(tmp_path):
    import signal
    import time

    file = tmp_path / "thin.scenario.yaml"
    file.write_text(SAFE)
    command = [sys.executable, "-m", "harness.cli", "search", file.name, "--runs", "40"]
    running = subprocess.Popen(command, cwd=tmp_path)
    journal = tmp_path / "reports/search/thin/results.jsonl"
    while not journal.exists() or len(journal.read_text().splitlines()) < 5:
        time.sleep(0.1)
    running.send_signal(signal.SIGINT)
    assert running.wait() == 130
    kept = len(journal.read_text().splitlines())
    done = subprocess.run([*command, "--resume"], cwd=tmp_path, check=False)
    assert done.returncode == 0
    lines = [line for line in journal.read_text().splitlines() if '"result"' in line]
    assert len(lines) == 41  # the nominal scenario is a run too
    assert len({json.loads(line)["key"] for line in lines}) == 41
    assert kept >= 5
