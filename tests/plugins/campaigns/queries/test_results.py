"""`harness results`: queries, comparisons and exports of the results of many runs."""

import csv
import json
import math
import os
from pathlib import Path

import pytest

from harness.cli.main import main
from harness.plugins.campaigns.queries.comparison import detectable_drop
from harness.recording.verdict import Verdict
from harness.reporting.result import CaseResult
from harness.suite.stream import StreamEntry
from tests.suite.ball import ball

SCENARIO = ball(8, rest="tags: [ball]\n", farthest="60 cm")


def entry(number, margin, *, line=7, seed=None, tag="pick", **values):
    """A line of a journal, as a run with this margin writes it."""
    status = "passed" if margin >= 0 else "failed"
    verdict = Verdict(
        expectation="lifted box, above 40 mm", status=status, margin=margin, unit="m",
        time=1.0, line=line, step="",
    )  # fmt: skip
    result = CaseResult(
        "pick.scenario.yaml", f"sample{number}", "Pick", status, f"{number}-{margin}",
        number if seed is None else seed, 2.0, verdicts=(verdict,),
    )  # fmt: skip
    return StreamEntry(f"key{number}", result, values, (tag,))


def journal(folder, entries):
    folder.mkdir(exist_ok=True)
    (folder / "results.jsonl").write_bytes(b"".join(each.line for each in entries))
    return str(folder)


def query(capsys, *words):
    """The exit code and the document of a query."""
    code = main(["results", *words, "--json"])
    return code, json.loads(capsys.readouterr().out)


def names(document):
    return [run["name"] for run in document["runs"]]


def test_a_real_campaign_is_queried_by_what_varied_in_it(tmp_path, capsys):
    file = tmp_path / "ball.scenario.yaml"
    file.write_text(SCENARIO)
    reports = str(tmp_path / "reports")
    main(["run", str(file), "--report-dir", reports, "--no-page", "-j", "2"])
    capsys.readouterr()
    _, failed = query(capsys, reports, "--outcome", "failed")
    _, beyond = query(capsys, reports, "--where", "x>=0.3 m")
    assert 0 < failed["selected"] < 8
    assert names(failed) == names(beyond)
    assert query(capsys, reports, "--tag", "ball")[1]["selected"] == 8
    assert main(["results", reports]) == 0
    assert f"8 runs: {8 - failed['selected']} passed" in capsys.readouterr().out.replace(
        f"{failed['selected']} failed, ", ""
    )


@pytest.mark.parametrize("changed", [{"seed": 2**63}, {"line": 10**30}])
def test_a_number_of_more_than_64_bits_is_an_error_of_the_results(changed, tmp_path, capsys):
    folder = journal(tmp_path / "a", [entry(1, 0.1), entry(2, 0.1, **changed)])
    assert main(["results", folder]) == 3
    said = capsys.readouterr().err
    assert "results.sqlite" in said
    assert "Traceback" not in said


@pytest.fixture
def reports(tmp_path, capsys, monkeypatch):
    """Runs samples of a ball into one folder; the counts of the suite and of the query."""
    monkeypatch.chdir(tmp_path)

    def run(text, *words):
        (tmp_path / "ball.scenario.yaml").write_text(text)
        main(["run", "ball.scenario.yaml", "--report-dir", "reports", "--no-page", *words])
        cases = json.loads((tmp_path / "reports/results.json").read_text())["cases"]
        capsys.readouterr()
        return len(cases), query(capsys, "reports", "--limit", "99")[1]

    return run


@pytest.mark.nightly
def test_samples_that_the_sequential_test_did_not_need_are_no_results(tmp_path, reports, capsys):
    """They are in the journal, as they were under way when the test decided."""
    early = ball(30, rest="expect_rate: 30 %\n", farthest="0 cm")
    counted, found = reports(early, "-j", "3")
    lines = (tmp_path / "reports/results.jsonl").read_bytes().count(b'"result"')
    assert found["selected"] == len(found["runs"]) == counted < 30
    assert found["left_out"] == lines - counted
    main(["results", "reports", "--csv", "runs.csv"])
    with (tmp_path / "runs.csv").open() as file:
        assert len(list(csv.DictReader(file))) == counted
    assert f"{counted} runs written" in capsys.readouterr().out


@pytest.mark.nightly
def test_results_of_cases_that_a_resumed_suite_no_longer_has_are_left_out(reports, capsys):
    text = ball(6, rest="")
    assert reports(text)[1]["left_out"] == 0
    counted, found = reports(text, "--samples", "4", "--resume")
    assert (counted, found["selected"], found["left_out"]) == (4, 4, 2)
    main(["results", "reports"])
    assert "2 more left out, as the suite does" in capsys.readouterr().out
    counted, found = reports(text, "--resume")
    assert (counted, found["selected"], found["left_out"]) == (6, 6, 0)


@pytest.mark.nightly
def test_results_of_an_older_version_of_a_file_are_replaced(reports, capsys):
    reports(ball(4, rest=""))
    counted, found = reports(ball(4, rest="tags: [changed]\n"), "--resume")
    assert (counted, found["selected"], found["left_out"]) == (4, 4, 0)
    assert query(capsys, "reports", "--tag", "changed")[1]["selected"] == 4


def test_conditions_understand_units_words_and_margins(tmp_path, capsys):
    folder = journal(
        tmp_path / "a",
        [
            entry(1, 0.01, friction=0.2, x="5 cm", color="red"),
            entry(2, -0.01, friction=0.5, x="15 cm", color="green", tag="place"),
            entry(3, 0.0004, friction=0.9, x="10 cm", color="red"),
        ],
    )
    expected = {
        ("--where", "friction<0.6"): {"sample1", "sample2"},
        ("--where", "x>60 mm", "--where", "color=red"): {"sample3"},
        ("--where", "x<=0.1 m"): {"sample1", "sample3"},
        ("--where", "margin<1 mm"): {"sample2", "sample3"},
        ("--cause", "Lifted"): {"sample2"},
        ("--tag", "place"): {"sample2"},
        ("--where", "seed!=3"): {"sample1", "sample2"},
    }
    for options, found in expected.items():
        assert set(names(query(capsys, folder, *options)[1])) == found, options


@pytest.mark.parametrize("condition", ["h=0.15", "h=15 cm", "h=150 mm", "h>0.12"])
def test_a_number_without_a_unit_is_si_where_a_parameter_has_several(tmp_path, capsys, condition):
    heights = (0.05, 0.1, "15 cm")
    folder = journal(tmp_path / "a", [entry(i, 0.01, h=h) for i, h in enumerate(heights)])
    assert names(query(capsys, folder, "--where", condition)[1]) == ["sample2"]


def test_a_document_has_parameters_as_numbers_where_they_have_no_unit(tmp_path, capsys):
    folder = journal(tmp_path / "a", [entry(1, 0.01, friction=0.2, x="5 cm", color="red")])
    (run,) = query(capsys, folder)[1]["runs"]
    assert (run["friction"], run["x"], run["color"]) == (0.2, "5 cm", "red")


def test_an_export_goes_into_a_pipe_and_to_where_a_link_leads(tmp_path, capsys):
    folder = journal(tmp_path / "a", [entry(1, 0.01)])
    pipe, link, target = (tmp_path / name for name in ("pipe", "link.csv", "target.csv"))
    os.mkfifo(pipe)
    link.symlink_to(target)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    for file in (pipe, link):
        assert main(["results", folder, "--csv", str(file)]) == 0
    assert os.read(reader, 10_000) == target.read_bytes()
    os.close(reader)
    assert pipe.is_fifo()
    assert link.is_symlink()
    assert main(["results", folder, "--csv", "/dev/full"]) == 3
    assert "No space left" in capsys.readouterr().err
    assert Path("/dev/full").is_char_device()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--where", "h<3"), "'h' has the units"),
        (("--where", "frction<1"), "did you mean `friction`?"),
        (("--where", "friction"), "write NAME<VALUE"),
        (("--where", "friction<red"), "'red' is not a number"),
        (("--where", "x<3 kg"), "'x' has the unit 'cm'"),
        (("--tag", "pik"), "did you mean `pick`?"),
    ],
)
def test_mistakes_in_a_query_are_explained(tmp_path, capsys, options, message):
    folder = journal(
        tmp_path / "a", [entry(1, 0.01, friction=0.2, x="5 cm", h="5 cm"), entry(2, 1, h="9 mm")]
    )
    assert main(["results", folder, *options]) == 2
    assert message in capsys.readouterr().err


def test_a_folder_without_results_is_refused_and_nothing_is_left_in_it(tmp_path, capsys):
    assert main(["results", str(tmp_path)]) == 2
    assert "has no results.jsonl" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_the_database_follows_its_journal(tmp_path, capsys):
    folder = journal(tmp_path / "a", [entry(1, 0.01), entry(2, 0.02)])
    assert query(capsys, folder)[1]["selected"] == 2
    lines = tmp_path / "a/results.jsonl"
    with lines.open("ab") as file:
        file.write(entry(3, 0.03).line + entry(2, -0.5).line + entry(4, 1).line[:-20])
    _, grown = query(capsys, folder)
    assert grown["selected"] == 3  # a repeated key replaces, half a line waits
    assert names(grown)[0] == "sample2"
    lines.write_bytes(entry(9, 0.01).line)
    assert names(query(capsys, folder)[1]) == ["sample9"]
    (tmp_path / "a/results.sqlite").write_bytes(b"no database" * 100)
    assert names(query(capsys, folder)[1]) == ["sample9"]


@pytest.mark.nightly
def test_a_worse_campaign_is_shown_by_pairs(tmp_path, capsys):
    first = journal(tmp_path / "a", [entry(i, 0.01 + i / 1e4) for i in range(40)])
    worse = journal(
        tmp_path / "b", [entry(i, (0.008 if i >= 10 else -0.02) + i / 1e4) for i in range(41)]
    )
    code, document = query(capsys, first, "--against", worse)
    found = document["comparison"]
    assert code == 1
    assert (found["pairs"], found["unpaired"]) == (40, 1)
    assert (found["broken"], found["repaired"]) == (10, 0)
    assert found["p_value"] == pytest.approx(2 * 0.5**10)
    [margin] = found["margins"]
    assert margin["median"] == pytest.approx(-0.002)
    assert margin["p_value"] < 1e-6
    assert query(capsys, worse, "--against", first)[0] == 0  # it is better


def test_without_a_difference_the_smallest_detectable_drop_is_stated(tmp_path, capsys):
    first = journal(tmp_path / "a", [entry(i, 0.01) for i in range(100)])
    assert main(["results", first, "--against", first]) == 0
    shown = capsys.readouterr().out
    assert "100 pairs of runs on the same conditions, 100 with equal digests" in shown
    assert "a drop of 7.7 percentage points or more would have been detected" in shown


def test_runs_with_other_seeds_are_no_pairs(tmp_path, capsys):
    first = journal(tmp_path / "a", [entry(i, 0.01) for i in range(3)])
    other = journal(tmp_path / "b", [entry(i, 0.01, seed=i + 1) for i in range(3)])
    assert main(["results", first, "--against", other]) == 2
    assert "no run of the same file, case and seed in common" in capsys.readouterr().err


@pytest.mark.parametrize("opposite", [0.0, 0.03])
def test_the_detectable_drop_is_detected_in_four_of_five_simulations(opposite):
    """Campaigns of 400 pairs with that drop, judged by the exact test."""
    import numpy as np
    from scipy.stats import binomtest

    drop, rng = detectable_drop(400, opposite), np.random.default_rng(1)
    broken = rng.binomial(400, drop + opposite, 300)
    repaired = rng.binomial(400, opposite, 300)
    detected = [
        b > r and binomtest(int(b), int(b + r)).pvalue < 0.05
        for b, r in zip(broken, repaired, strict=True)
    ]
    assert np.mean(detected) == pytest.approx(0.8, abs=0.12)
    assert math.isnan(detectable_drop(0, 0.0))


def test_selected_runs_are_exported_as_csv(tmp_path, capsys):
    folder = journal(
        tmp_path / "a", [entry(1, 0.01, friction=0.2), entry(2, -0.01, friction=0.5, x="1 cm")]
    )
    file = tmp_path / "runs.csv"
    assert main(["results", folder, "--outcome", "failed", "--csv", str(file)]) == 0
    [row] = csv.DictReader(file.read_text().splitlines())
    assert (row["name"], row["friction"], row["x"]) == ("sample2", "0.5", "1 cm")
    assert float(row["margin"]) == -0.01
    assert "1 runs written" in capsys.readouterr().out


def test_selected_runs_are_exported_as_parquet(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    folder = journal(
        tmp_path / "a", [entry(1, 0.01, friction=0.2, x="2 cm"), entry(2, 0.3, friction=1)]
    )
    file = tmp_path / "runs.parquet"
    assert main(["results", folder, "--parquet", str(file)]) == 0
    table = parquet.read_table(file).to_pydict()
    assert table["friction"] == [0.2, 1.0]
    assert table["x"] == ["2 cm", None]
    assert table["margin"] == [0.01, 0.3]
