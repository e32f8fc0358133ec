"""A suite's page in a real browser, opened from disk."""

import pytest

from harness.cli.main import main
from harness.reporting.suite.write import write_suite
from tests.reporting.suites import large_suite, small_suite


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    history = {("a/pick.scenario.yaml", "c0"): [0.5, 0.4, None, 0.3]}
    return write_suite(tmp_path_factory.mktemp("small"), small_suite(), 3, history)[0]


@pytest.fixture(scope="module")
def large(tmp_path_factory):
    return write_suite(tmp_path_factory.mktemp("large"), large_suite(2000), 1)[0]


def names(page):
    return [text.split("[")[-1].split("]")[0] for text in
            page.locator("tbody tr:not(.group) td:nth-child(2)").all_inner_texts()]  # fmt: skip


def test_it_lists_everything_and_hostile_names_stay_text(small, visit):
    seen = visit(small)
    page = seen.page
    assert page.title() == "1 of 5 passed; 1 of 1 success rates not confirmed"
    assert page.locator("tbody tr").count() == 5
    assert "<script>document.title" in seen.text("tbody")
    assert "8 of 10 samples passed, 80.0%" in seen.text("main")
    assert page.locator("svg.spark").count() == 1
    link = page.get_attribute("tbody a", "href")
    assert link.endswith("a/pick/c1/report.html#t=2.00&expect=2")


def columns(page, row):
    """The cells of a row of cases by the heading that is drawn above them."""
    middle = "each => each.map((cell) => { const box = cell.getBoundingClientRect();"
    middle += " return [cell.innerText, box.left, box.right]; })"
    heads = page.locator("thead th").evaluate_all(middle)
    cells = page.locator("tbody tr").nth(row).locator("td").evaluate_all(middle)
    assert len(heads) == len(cells)
    assert [head[1:] for head in heads] == [cell[1:] for cell in cells]
    return {
        head[0].partition("bar:")[0].strip(): cell[0]
        for head, cell in zip(heads, cells, strict=True)
    }


@pytest.mark.parametrize("history", [None, {}, {("a/pick.scenario.yaml", "c0"): [0.5, 0.4]}])
def test_every_cell_stands_under_its_heading(history, tmp_path, visit):
    page = visit(write_suite(tmp_path, small_suite(), 3, history)[0], width=1400).page
    for row, seed in enumerate(("0", "1", "3")):
        found = columns(page, row)
        assert (found["Seed"], found["Simulated"]) == (seed, "4.0 s" if row == 2 else "9.0 s")
        assert ("Worst margin over runs" in found) == bool(history)
    page.select_option("#order select", "cause")
    assert page.locator("tr.group td").first.get_attribute("colspan") == str(len(found))


def test_bars_show_the_share_of_the_allowance_that_was_used(small, visit):
    page = visit(small).page
    said = page.locator(".bar").evaluate_all("bars => bars.map((bar) => bar.title)")
    assert said == ["83 % of the allowance used", "167 % of the allowance used"]
    widths = page.locator(".bar i").evaluate_all("bars => bars.map((bar) => bar.style.width)")
    assert widths == ["83.3%", "100%"]


def test_filters_search_and_address(small, visit):
    page = visit(small).page
    page.click("[data-outcome=failed]")
    assert page.locator("tbody tr").count() == 2
    page.click("#causes button:has-text('NO_IK_SOLUTION')")
    assert page.locator("tbody tr").count() == 1
    page.click("#causes button:has-text('NO_IK_SOLUTION')")
    page.fill("#search input", "req-7")
    assert page.locator("tbody tr").count() == 0
    page.click("[data-outcome=failed]")
    assert page.locator("tbody tr").count() == 1
    assert "search=req-7" in page.evaluate("location.hash")
    again = visit(small, page.evaluate("location.hash")).page
    assert again.locator("tbody tr").count() == 1


def test_sorted_by_worst_margin_and_grouped_by_cause(small, visit):
    page = visit(small).page
    page.select_option("#order select", "share")
    assert names(page)[:2] == ["c1", "c0"]
    page.select_option("#order select", "cause")
    heads = page.locator("tr.group").all_inner_texts()
    assert len(heads) == 5
    assert heads[-1].strip() == "passed (1)"


def test_a_rate_leads_to_its_samples(small, visit):
    page = visit(small).page
    page.click(".rate.failed")
    assert names(page) == ["c0", "c1"]


def test_two_thousand_rows_are_searched_and_sorted(large, visit):
    page = visit(large).page
    assert page.locator("tbody tr").count() == 2000
    page.fill("#search input", "c1999")
    assert names(page) == ["c1999"]
    page.fill("#search input", "")
    page.select_option("#order select", "share")
    shares = page.eval_on_selector_all("tbody tr", "rows => rows.map((row) => +row.dataset.share)")
    assert shares == sorted(shares)
    assert len(shares) == 2000


def test_without_scripts_and_on_a_phone_every_row_is_there(small, visit):
    page = visit(small, scripts=False, width=390).page
    assert page.locator("tbody tr").count() == 5
    assert not page.locator("#search").is_visible()
    phone = visit(small, width=390).page
    assert phone.evaluate("document.documentElement.scrollWidth") <= 390


def test_view_opens_the_page_of_many_runs_and_says_where_a_run_is(small, tmp_path, capsys):
    assert main(["view", str(small.parent), "--no-open"]) == 0
    assert capsys.readouterr().out == f"{small}\n"
    (tmp_path / "pick").mkdir()
    (tmp_path / "pick/run.json").write_text("{}")
    assert main(["view", str(tmp_path), "--no-open"]) == 2
    assert f"there is a run in '{tmp_path}/pick'" in capsys.readouterr().err
