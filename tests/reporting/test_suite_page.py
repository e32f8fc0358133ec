"""A suite's page in a real browser, opened from disk."""

import platform
import re
import shlex
import weakref
from dataclasses import replace

import cv2
import numpy as np
import pytest

from harness.cli.main import main
from harness.core.lazy import LazySequence
from harness.reporting.result import StepLine
from harness.reporting.sampled import SampledRate
from harness.reporting.suite.columns import Columns
from harness.reporting.suite.page import MOST_PLAIN_ROWS, MOST_ROWS, suite_html
from harness.reporting.suite.record import SuiteCase, SuiteRecord
from harness.reporting.suite.write import write_suite
from tests.reporting.browser import wait_for
from tests.reporting.suites import (
    INVALID,
    STUCK,
    failed,
    large_suite,
    passed,
    small_suite,
    verdict,
)
from tests.suite.samples import rate_of


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    history = {("a/pick.scenario.yaml", "c0"): [0.5, 0.4, None, 0.3]}
    return write_suite(tmp_path_factory.mktemp("small"), small_suite(), 3, history)[0]


@pytest.fixture(scope="module")
def large(tmp_path_factory):
    return write_suite(tmp_path_factory.mktemp("large"), large_suite(10_000), 1)[0]


def names(page):
    """The names of the cases that are drawn, in their order."""
    return [text.split("[")[-1].split("]")[0] for text in
            page.locator("tr.case .title").all_inner_texts()]  # fmt: skip


def test_it_lists_everything_and_hostile_names_stay_text(small, visit):
    seen = visit(small)
    page = seen.page
    assert page.title() == "1 of 5 passed; success rate not confirmed"
    assert page.locator("tr.case").count() == 5
    assert "<script>document.title" in seen.text("tbody")
    assert "8 of 10 samples passed, 80.0%" in seen.text("main")
    assert page.locator("svg.spark").count() == 1
    link = page.get_attribute("tr.case a", "href")
    assert link.endswith("a/pick/c1/report.html#t=2.00&expect=2")


def test_samples_of_one_file_are_named_without_what_they_share(visit, tmp_path):
    cases = [SuiteCase(passed(each), {"x": each / 10}, ("ur",)) for each in range(3)]
    seen = visit(write_suite(tmp_path, SuiteRecord("passed", cases), 0)[0])
    assert [each.strip() for each in seen.page.locator("tr.case .title").all_inner_texts()] == [
        "c0",
        "c1",
        "c2",
    ]
    assert "x 0.2" in seen.text("tbody")
    assert "pick.scenario.yaml" not in seen.text("tbody")
    assert not seen.page.locator("td.still").first.is_visible(), "a column of pictures without one"


def test_the_time_of_the_suite_is_not_the_sum_of_its_cases(small, visit, tmp_path):
    assert "the cases add up to 0.2 s" in visit(small).text("#outcomes")
    page = write_suite(tmp_path, replace(small_suite(), wall=200.0), 3)[0]
    assert "took 3 min 20 s" in visit(page).text("#outcomes")


def test_failures_come_first_with_their_cause_in_a_line_and_details_on_a_click(small, visit):
    page = visit(small).page
    outcomes = page.locator("tr.case").evaluate_all(
        "rows => rows.map((row) => row.dataset.outcome)"
    )
    assert outcomes[-1] == "passed"
    assert "passed" not in outcomes[:-1]
    row = page.locator("tr.case", has_text="[c1]")
    assert row.locator("summary").inner_text() == "lifted cube: 30 mm"
    assert not row.locator("pre").is_visible()
    row.locator("summary").click()
    assert "height: 30.0 mm (at least 50.0 mm)" in row.locator("pre").inner_text()
    assert "harness run a/pick.scenario.yaml --case c1" in row.locator(".facts").inner_text()


def test_the_command_of_a_case_has_the_options_of_the_suite(tmp_path, visit):
    suite = small_suite()
    options = ("--set", "params.lift=5 cm")
    cases = [replace(case, options=options) for case in suite.cases]
    page = visit(write_suite(tmp_path, replace(suite, cases=cases), 3)[0]).page
    row = page.locator("tr.case", has_text="[c1]")
    row.locator("summary").click()
    command = "harness run a/pick.scenario.yaml --case c1 --set 'params.lift=5 cm'"
    assert command in row.locator(".facts").inner_text()


def test_a_failure_shows_the_picture_of_the_moment_that_decided_it(tmp_path, visit):
    folder = tmp_path / "a/pick/c1"
    (folder / "images").mkdir(parents=True)
    picture = np.zeros((480, 640, 3), np.uint8)
    for name, grey in (("01-home", 40), ("02-pick", 250), ("03-lift", 120)):
        cv2.imwrite(str(folder / f"images/{name}.jpg"), picture + grey)
    steps = [StepLine(name, "move_to", name, "passed", sim_time=1.5, path=f"steps[{number}]")
             for number, name in enumerate(("home", "pick", "lift"))]  # fmt: skip
    result = replace(failed(1), steps=tuple(steps), report_dir=str(folder))  # decided at 2 s
    page = visit(write_suite(tmp_path, SuiteRecord("failed", [SuiteCase(result)]), 1)[0]).page
    shade = page.locator(".still img").evaluate(
        "async (still) => { await still.decode(); const canvas = document.createElement('canvas');"
        " const pen = canvas.getContext('2d'); pen.drawImage(still, 0, 0);"
        " return pen.getImageData(20, 20, 1, 1).data[0]; }"
    )
    assert shade > 200, "the second step, in which it was decided"


def test_a_passed_case_shows_the_picture_of_its_end(tmp_path, visit):
    folder = tmp_path / "a/pick/c0"
    (folder / "images").mkdir(parents=True)
    for name in ("01-home", "02-pick"):
        cv2.imwrite(str(folder / f"images/{name}.jpg"), np.zeros((48, 64, 3), np.uint8))
    result = replace(passed(0), report_dir=str(folder))
    page = visit(write_suite(tmp_path, SuiteRecord("passed", [SuiteCase(result)]), 0)[0]).page
    assert page.locator(".still img").get_attribute("alt") == "the end: Pick [c0]"
    assert page.locator(".still img").is_visible()


def test_rows_with_one_title_are_distinguished_and_link_back_from_their_runs(tmp_path, visit):
    folder = tmp_path / "b/place"
    here = replace(STUCK, report_dir=str(folder), page=str(folder / "report.html"))
    others = [replace(passed(0), file=f"{name}.scenario.yaml", case="") for name in ("one", "two")]
    cases = [SuiteCase(each) for each in (here, *others)]
    page = visit(write_suite(tmp_path, SuiteRecord("failed", cases), 1)[0]).page
    titles = [each.strip() for each in page.locator("span.title").all_inner_texts()]
    assert titles == ["Place", "Pick · one", "Pick · two"]
    link = page.locator("tr.case a").first.get_attribute("href")
    assert link == "b/place/report.html#t=4.00&tab=planner&suite=../../index.html"


@pytest.mark.nightly(but=[0, 1])
@pytest.mark.parametrize(
    ("suite", "shown"),
    [("../../index.html", True), ("javascript:alert(1)", False), ("http://a.b/index.html", False)],
)
def test_a_run_leads_back_to_its_suite_and_nowhere_else(failed_run, suite, shown, visit):
    page = visit(failed_run / "report.html", f"#t=0.10&suite={suite}").page
    back = page.locator("#suite")
    assert back.is_visible() == shown
    assert (back.get_attribute("href") == suite) == shown
    page.keyboard.press("End")
    wait_for(page, "!location.hash.includes('t=0.10')")
    assert (suite in page.url) == shown


def columns(page, row):
    """The cells of a row of cases by the heading that is drawn above them."""
    middle = "each => each.map((cell) => { const box = cell.getBoundingClientRect();"
    middle += " return [cell.innerText, box.left, box.right]; })"
    heads = page.locator("thead th").evaluate_all(middle)
    cells = page.locator("tr.case").nth(row).locator("td").evaluate_all(middle)
    assert len(heads) == len(cells)
    assert [head[1:] for head in heads] == [cell[1:] for cell in cells]
    return {
        head[0].partition("bar:")[0].strip(): cell[0]
        for head, cell in zip(heads, cells, strict=True)
    }


@pytest.mark.nightly(but=[2])
@pytest.mark.parametrize("history", [None, {}, {("a/pick.scenario.yaml", "c0"): [0.5, 0.4]}])
def test_every_cell_stands_under_its_heading(history, tmp_path, visit):
    page = visit(write_suite(tmp_path, small_suite(), 3, history)[0], "#sort=number").page
    for row, took in enumerate(("0.3 s", "\u2013", "\u2013")):
        found = columns(page, row)
        assert found["Took"] == took
        assert ("Worst margin over runs" in found) == bool(history)
    fits = "heads => heads.every((head) => head.scrollWidth <= head.clientWidth)"
    assert page.locator("thead th").evaluate_all(fits), "a heading is longer than its column"
    page.select_option("#group select", "cause")
    assert page.locator("tr.group td").first.get_attribute("colspan") == str(len(found))


def test_bars_show_the_share_of_the_allowance_that_was_used(small, visit):
    page = visit(small, "#sort=number").page
    said = page.locator(".bar").evaluate_all("bars => bars.map((bar) => bar.title)")
    assert said == ["83 % of the allowance used", "167 % of the allowance used"]
    widths = page.locator(".bar i").evaluate_all("bars => bars.map((bar) => bar.style.width)")
    assert widths == ["83%", "100%"]


def near(used):
    """A case of a limit of 50 mm of which a share was used."""
    return SuiteCase(replace(passed(int(100 * used)), verdicts=(verdict(0.05 / used),)))


@pytest.mark.nightly
def test_a_bar_warns_from_nine_tenths_of_the_allowance(tmp_path, visit):
    cases = [near(used) for used in (0.5, 0.88, 0.91, 1.0)]
    page = visit(write_suite(tmp_path, SuiteRecord("passed", cases), 0)[0], "#sort=number").page
    bars = page.locator(".bar i").evaluate_all("bars => bars.map((bar) => bar.className)")
    assert bars == ["good", "good", "warn", "warn"]
    said = page.locator(".bar").evaluate_all("bars => bars.map((bar) => bar.title)")
    assert [each.endswith(": nearly all of it") for each in said] == [False, False, True, True]


@pytest.mark.nightly
def test_a_row_without_a_bar_says_why(tmp_path, visit):
    of_zero = replace(verdict(0.06).measures[0], limit=0.0)
    turned = replace(verdict(0.06), expectation="turned by 30.0 deg", measures=(of_zero,))
    results = [
        replace(passed(0), verdicts=()),
        replace(passed(1), verdicts=(turned,)),
        replace(passed(2), verdicts=(), steps=(replace(STUCK.steps[0], status="expected error"),)),
        STUCK,
        replace(STUCK, verdicts=(verdict(0.06),)),
        INVALID,
    ]
    record = SuiteRecord("failed", [SuiteCase(each) for each in results])
    page = visit(write_suite(tmp_path, record, 1)[0], "#sort=number").page
    said = [each.replace("\n", " ") for each in page.locator("td.nearest").all_inner_texts()]
    assert page.locator("[title^='no bar: its limit is 0']").inner_text() == "10.0 mm"
    assert said == [
        "expects nothing",
        "10.0 mm turned by 30.0°",
        "a step failed as expected",
        "expects nothing",
        "a step failed; what was judged holds",
        "not judged",
    ]


def test_the_page_says_when_from_what_and_where_it_was_made(small, visit):
    said = visit(small).text("#made")
    assert re.search(r"^20\d\d-\d\d-\d\d \d\d:\d\d UTC · (commit [0-9a-f]{10} · )?armharness", said)
    assert f"Python {platform.python_version()} · {platform.system()} " in said
    assert "--history DIR" not in said


def test_what_passed_is_said_in_the_title_and_at_its_filter(tmp_path, visit):
    cases = [SuiteCase(passed(i)) for i in range(3)]
    page = visit(write_suite(tmp_path, SuiteRecord("passed", cases), 0)[0]).page
    shown = page.evaluate("document.body.innerText.match(/passed/g).length")
    hidden = page.locator("tr.case .hidden").all_inner_texts()
    assert shown - len(hidden) == 2
    assert hidden == ["passed"] * 3, "for who hears the page"
    assert "--history DIR" in page.inner_text("#made")


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(
    ("good", "verdict_of_rate", "sign"), [(19, "open", "open"), (10, "refuted", "failed")]
)
def test_a_rate_that_is_undecided_is_amber_and_says_what_decides_it(
    tmp_path, visit, good, verdict_of_rate, sign
):
    cases = [SuiteCase(passed(i) if i < good else failed(i, 0.04), {"x": i}) for i in range(24)]
    rate = rate_of([i < good for i in range(24)], 0.85, 0.95, stop_early=False)
    assert rate.verdict == verdict_of_rate
    rates = [SampledRate("a/pick.scenario.yaml", "", rate, "failed")]
    page = visit(write_suite(tmp_path, SuiteRecord("failed", cases, rates), 1)[0]).page
    assert page.locator(f"h1 .sign.{sign}").count() == page.locator(f".rate.{sign}").count() == 1
    color = "each => getComputedStyle(each, '::before').color"
    name = page.locator(".rate b").evaluate("each => getComputedStyle(each).color")
    assert name == page.locator("h1 .sign").evaluate(color)
    assert ("more samples would decide it" in page.inner_text(".rate")) is (sign == "open")


def test_filters_search_and_address(small, visit):
    page = visit(small).page
    page.click("button[data-outcome=failed]")
    assert page.locator("tr.case").count() == 2
    page.click("#causes button:has-text('NO_IK_SOLUTION')")
    assert page.locator("tr.case").count() == 1
    page.click("#causes button:has-text('NO_IK_SOLUTION')")
    page.fill("#search input", "req-7")
    assert page.locator("tr.case").count() == 0
    page.click("button[data-outcome=failed]")
    page.select_option("#group select", "tag")
    assert page.locator("tr.case").count() == 2, "the case has two tags"
    assert "search=req-7" in page.evaluate("location.hash")
    again = visit(small, page.evaluate("location.hash")).page
    assert again.locator("tr.group .name").all_inner_texts() == ["lesson", "ur"]


def test_groups_have_their_outcomes_and_fold(small, visit):
    page = visit(small, "#group=folder").page
    heads = page.locator("tr.group")
    assert heads.locator(".name").all_inner_texts()[:2] == ["a", "b"]
    assert heads.first.locator(".number").inner_text() == "1 of 2 passed"
    assert heads.first.locator(".outcomes").get_attribute("aria-label") == "1 failed, 1 passed"
    heads.first.locator("button").click()
    assert heads.first.locator("button").get_attribute("aria-expanded") == "false"
    assert page.locator("tr.case").count() == 3
    assert page.locator("tr.group").count() == 4


def test_sorted_by_worst_margin_and_grouped_by_cause(small, visit):
    page = visit(small).page
    page.select_option("#order select", "share")
    assert names(page)[:2] == ["c1", "c0"]
    page.select_option("#group select", "cause")
    heads = page.locator("tr.group").all_inner_texts()
    assert len(heads) == 5
    assert heads[-1].startswith("passed")


def test_a_rate_leads_to_its_samples(small, visit):
    page = visit(small).page
    page.click(".rate")
    assert sorted(names(page)) == ["c0", "c1"]


@pytest.mark.nightly
def test_ten_thousand_rows_are_searched_grouped_and_scrolled(large, visit):
    """Each takes less than what a person notices; rows are drawn as far as the page is scrolled."""
    page = visit(large).page
    assert page.locator("#count").inner_text() == "10000"
    assert page.locator("tr.case").count() < 500
    page.fill("#search input", "c1999")
    assert names(page) == ["c1999"]
    page.fill("#search input", "")
    page.select_option("#group select", "cause")
    assert page.locator("tr.group").first.inner_text().startswith("failed: lifted cube")
    page.select_option("#group select", "")
    before = page.locator("tr.case").count()
    page.locator(".more").scroll_into_view_if_needed()
    wait_for(page, f"document.querySelectorAll('tr.case').length > {before}")
    shares = page.eval_on_selector_all("tr.case", "rows => rows.map((row) => +row.dataset.share)")
    assert shares == sorted(shares)


def test_without_scripts_and_on_a_phone_every_row_is_there(small, visit):
    page = visit(small, scripts=False, width=390).page
    assert page.locator(".plain li").count() == 5
    assert not page.locator("#search").is_visible()
    assert not page.locator("#cases table").is_visible()
    phone = visit(small, width=390).page
    assert phone.evaluate("document.documentElement.scrollWidth") <= 390
    assert phone.locator("tr.case").count() == 5


def test_view_opens_the_page_of_many_runs_and_says_where_a_run_is(small, tmp_path, capsys):
    assert main(["view", str(small.parent), "--no-open"]) == 0
    assert capsys.readouterr().out == f"{small}\n"
    (tmp_path / "pick").mkdir()
    (tmp_path / "pick/run.json").write_text("{}")
    assert main(["view", str(tmp_path), "--no-open"]) == 2
    assert f"there is a run in '{tmp_path}/pick'" in capsys.readouterr().err


def test_a_case_offers_the_command_that_compares_it_with_another_one(tmp_path, visit):
    near = replace(passed(2), report_dir="a/pick/it's 2", page="a/pick/it's 2/report.html")
    far = replace(STUCK, report_dir="b/place", outcome="passed")
    alone = SuiteRecord("failed", [SuiteCase(failed(1)), SuiteCase(STUCK)])
    record = SuiteRecord("failed", [SuiteCase(each) for each in (failed(1), far, near)])
    write_suite(tmp_path / "one", alone, 1)
    write_suite(tmp_path / "three", record, 1)
    page = visit(tmp_path / "one" / "index.html").page
    page.wait_for_selector("tr.case")
    assert page.locator("button.compare").count() == 0, "there is no other run"
    page = visit(tmp_path / "three" / "index.html").page
    page.click("tr.case[data-outcome=failed] summary")
    page.click("tr.case[data-outcome=failed] button.compare")
    assert page.locator(".compared option").all_inner_texts() == [
        f"{near.name} (passed)", f"{far.name} (passed)"
    ]  # fmt: skip
    words = shlex.split(page.inner_text(".compared code"))
    assert words == ["harness", "compare", near.report_dir, "a/pick/c1"]
    page.select_option(".compared select", index=1)
    assert page.inner_text(".compared code") == "harness compare b/place a/pick/c1"
    page.click(".compared .copy")
    assert page.evaluate("getSelection().toString()") == "harness compare b/place a/pick/c1"


def test_pages_of_other_reporters_are_linked(tmp_path, visit):
    report = tmp_path / "a" / "pick" / "c1"
    report.mkdir(parents=True)
    for name in ("report", "against_last_green"):
        (report / f"{name}.html").write_text("<!doctype html><title>page</title>")
    case = replace(failed(1), report_dir=str(report), page=str(report / "report.html"))
    write_suite(tmp_path, SuiteRecord("failed", [SuiteCase(case), SuiteCase(STUCK)]), 1)
    page = visit(tmp_path / "index.html").page
    page.click("a.page:text-is('against last green')")
    page.wait_for_url("**/a/pick/c1/against_last_green.html")


def test_the_page_keeps_few_cases_in_memory_at_once(tmp_path):
    alive, most = [0], [0]

    def case(number):
        found = SuiteCase(passed(number, 0.1), {"height": "5 cm"})
        alive[0] += 1
        most[0] = max(most[0], alive[0])
        weakref.finalize(found, lambda: alive.__setitem__(0, alive[0] - 1))
        return found

    cases = LazySequence(3 * MOST_PLAIN_ROWS, case)
    columns = Columns(cases, most_listed=MOST_ROWS)
    assert "600 of 600 passed" in suite_html(SuiteRecord("passed", cases, []), columns, tmp_path)
    assert most[0] <= MOST_PLAIN_ROWS + 2
