"""The page of many samples: a map of the runs, margins, sensitivities, and drawn values."""

import random
from dataclasses import replace

import numpy as np
import pytest

from harness.reporting.suite.campaign import campaign_html, sensitivities
from harness.reporting.suite.columns import Columns
from harness.reporting.suite.record import SuiteCase, SuiteRecord
from harness.reporting.suite.write import write_suite_page
from tests.reporting.suites import failed, passed


def campaign(count, words=("red", "green")):
    """Runs that fail with little friction; the two other parameters do not matter."""
    rng, cases = random.Random(3), []
    for number in range(count):
        friction, x = rng.uniform(0, 1), rng.uniform(-20, 20)
        height = 0.04 + 0.03 * friction
        result = passed(number, height) if height >= 0.05 else failed(number, height)
        values = {"friction": friction, "x": f"{x} cm", "color": rng.choice(words)}
        cases.append(SuiteCase(replace(result, case=f"sample{number}"), values))
    return cases


@pytest.fixture(scope="module")
def page_file(tmp_path_factory):
    folder = tmp_path_factory.mktemp("campaign")
    target = folder / "a/pick/c1"
    target.mkdir(parents=True)
    (target / "report.html").write_text("<title>one run</title>")
    cases = [
        each if each.result.outcome == "passed" else SuiteCase(
            replace(each.result, report_dir=str(target), page=str(target / "report.html")),
            each.values,
        )
        for each in campaign(60)
    ]  # fmt: skip
    return write_suite_page(folder, SuiteRecord("failed", cases))


FIND = """
words => {
  const canvas = document.querySelector("#map canvas");
  const said = document.querySelector("#map output");
  const box = canvas.getBoundingClientRect();
  for (let x = box.left + 60; x < box.right - 10; x += 9) {
    for (let y = box.top + 24; y < box.bottom - 34; y += 9) {
      canvas.dispatchEvent(new PointerEvent("pointermove", { clientX: x, clientY: y }));
      if (said.textContent.includes(words)) return [x, y];
    }
  }
}
"""


def place_of(page, words):
    """Where on the map a run is whose description has these words."""
    place = page.evaluate(FIND, words)
    assert place, f"no run on the map says '{words}'"
    page.mouse.move(*place)
    assert words in page.locator("#map output").inner_text()
    return place


def test_a_failed_run_on_the_map_is_described_and_opens_with_a_click(page_file, visit):
    page = visit(page_file).page
    assert page.locator("#map select[name=x] option").all_inner_texts() == [
        "friction", "x [cm]", "color", "worst margin (share of its limit)",
    ]  # fmt: skip
    x, y = place_of(page, "failed: lifted cube; friction 0.")
    page.mouse.click(x, y)
    page.wait_for_url("**/report.html")
    assert page.title() == "one run"


def test_a_passed_run_without_a_report_is_found_in_the_table(page_file, visit):
    page = visit(page_file).page
    place = place_of(page, ": passed; friction")
    name = page.locator("#map output").inner_text().split(":")[0]
    page.mouse.click(*place)
    assert name in page.locator("tbody").inner_text()
    assert page.locator("tbody tr").count() < 15


def test_the_failure_rate_is_shown_for_each_cell(page_file, visit):
    page = visit(page_file).page
    page.select_option("#map select[name=kind]", "rate")
    page.select_option("#map select[name=y]", "2")
    place_of(page, "runs failed")


def test_the_map_fits_a_narrow_screen(page_file, visit):
    page = visit(page_file).page
    page.set_viewport_size({"width": 390, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_a_row_has_the_values_of_its_run(page_file, visit):
    text = visit(page_file).page.locator("tbody tr").first.inner_text()
    assert "friction 0.238, x 1.769 cm, color green" in text


def test_the_parameter_that_decides_is_the_most_sensitive():
    columns = Columns(campaign(400))
    found = sensitivities(columns, columns.parameters)
    assert found["friction"] > 0.9
    assert found["x"] < 0.05
    assert found["color"] < 0.05


def test_sensitivities_of_noise_are_near_zero_on_average():
    """The share is corrected for what chance puts between groups."""
    rng, shares = np.random.default_rng(0), []
    for _ in range(20):
        columns = Columns(
            SuiteCase(passed(i, value), {"x": float(rng.random())})
            for i, value in enumerate(0.06 + 0.02 * rng.random(100))
        )
        shares.append(sensitivities(columns, columns.parameters)["x"])
    assert np.mean(shares) < 0.03


def test_a_page_of_many_samples_stays_small(tmp_path):
    page = write_suite_page(tmp_path, SuiteRecord("failed", campaign(20_000)))
    text = page.read_text()
    assert len(text) < 5_000_000
    assert "10000 of 20000 runs are drawn" in text
    assert "18000 more cases are not listed" in text
    assert text.count("<tr data-index") == 2000


def test_hostile_words_stay_text(tmp_path, visit):
    words = ("</script><script>document.title = 'taken over'</script>", "<b>bold</b>")
    page = write_suite_page(tmp_path, SuiteRecord("failed", campaign(20, words)))
    seen = visit(page)
    assert "taken over" not in seen.page.title()
    seen.page.select_option("#map select[name=y]", "2")
    assert seen.complaints == []


def test_few_runs_and_runs_without_variation_have_no_map(tmp_path):
    for cases in (campaign(4), [SuiteCase(passed(i)) for i in range(50)]):
        assert campaign_html(Columns(cases), cases, tmp_path) == ""
