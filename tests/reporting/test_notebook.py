"""A result as a notebook shows it."""

from contextlib import closing
from dataclasses import replace

import cv2
import numpy as np
import pytest

from harness.reporting.notebook import result_html
from harness.reporting.suite.failure_picture import deciding_still
from tests.reporting.browser import new_context
from tests.reporting.suites import BROKEN, HOSTILE, STUCK, failed, passed


def test_a_result_shows_its_outcome_and_its_verdicts():
    shown = result_html(passed(0))
    assert ">passed</b> <b>Pick [c0]</b>" in shown
    assert "lifted cube" in shown
    assert "passed by 10.0 mm" in shown
    assert "<pre>" not in shown


@pytest.mark.nightly(but=["#111111"])
@pytest.mark.parametrize("ground", ["#ffffff", "#111111"])
def test_signs_and_links_are_read_in_light_and_dark_notebooks(tmp_path, ground, browser):
    """A white sign on green or red, and a link in the colour of the text."""
    text = result_html(replace(failed(1), page=str(tmp_path / "report.html")))
    ink = "#000000" if ground == "#ffffff" else "#dddddd"
    with closing(new_context(browser, offline=True)) as context:
        opened = context.new_page()
        opened.set_content(f'<body style="background:{ground};color:{ink}">{text}')
        looks = "(each) => [getComputedStyle(each).color, getComputedStyle(each).backgroundColor]"
        signs = {
            tuple(each.evaluate(looks)) for each in opened.locator("td > span:only-child").all()
        }
        assert signs == {("rgb(255, 255, 255)", "rgb(26, 127, 55)"),
                         ("rgb(255, 255, 255)", "rgb(207, 34, 46)")}  # fmt: skip
        link = opened.locator("a").evaluate(looks)[0]
        assert link == opened.locator("body").evaluate(looks)[0]


def test_a_failure_shows_its_causes_its_picture_and_its_page(tmp_path):
    (tmp_path / "images").mkdir()
    cv2.imwrite(str(tmp_path / "images/01-go.jpg"), np.full((480, 640, 3), 200, np.uint8))
    page = tmp_path / "report.html"
    shown = result_html(replace(STUCK, report_dir=str(tmp_path), page=str(page)))
    assert "NO_IK_SOLUTION: out, by 9 mm" in shown
    assert 'src="data:image/webp;base64,' in shown
    assert f'href="{page.as_uri()}#t=4.00&amp;tab=planner"' in shown
    assert "height: 30.0 mm (at least 50.0 mm)" in result_html(failed(1))


@pytest.mark.parametrize(
    ("files", "shown"),
    [
        (["01-go.jpg"], "01-go.jpg"),
        (["01-go.jpg", "01-go-why.jpg"], "01-go-why.jpg"),
        (["01-steps-0.jpg", "01-steps-0-why.jpg", "02-b-why.jpg"], "01-steps-0-why.jpg"),
        (["02-b.jpg"], None),
    ],
)
def test_the_picture_that_explains_a_failure_is_the_one_that_is_shown(tmp_path, files, shown):
    (tmp_path / "images").mkdir()
    for name in files:
        (tmp_path / "images" / name).touch()
    found = deciding_still(replace(STUCK, report_dir=str(tmp_path)))
    assert (found and found.name) == shown


def test_everything_that_was_found_is_folded_where_the_table_says_it():
    assert "<details><summary" in result_html(failed(1))
    assert "<details open><summary" in result_html(STUCK), "what a step says is in no table"


def test_what_does_not_hold_stands_first_and_no_line_is_wider_than_the_cell():
    first, second = passed(0), failed(1)
    both = replace(second, verdicts=(*first.verdicts, *second.verdicts))
    shown = result_html(both)
    assert shown.index(">✕</span>") < shown.index(">✓</span>")
    assert '<pre style="white-space:pre-wrap">' in shown


def test_hostile_texts_stay_text():
    shown = result_html(BROKEN)
    assert HOSTILE not in shown
    assert "<script" not in shown
