"""The page of two runs in a real browser, and how their steps are aligned."""

import re
from pathlib import Path

import pytest

from harness.cli.main import main
from harness.plugins.comparison.alignment import aligned_steps
from harness.plugins.comparison.compare import compare
from harness.plugins.comparison.html import distinct_parts
from harness.recording.read_run import read_run
from tests.judging.synthetic_run import make_run, step
from tests.reporting.browser import visits, wait_for_frame
from tests.reporting.test_page import picture
from tests.running import exit_code

ONE = """\
scenario: two turns
robot: open_manipulator_x
steps:
  - ptp: {joints: {joint1: 0.6}}
    id: turn
  - wait: 0.2
  - ptp: {joints: {joint1: 0.0}}
expect:
  - duration: {at_most: 10 s}
"""
OTHER = ONE.replace("0.6", "1.2").replace("  - wait: 0.2\n", "  - gripper: closed\n  - wait: 0.2\n")


@pytest.fixture(scope="module")
def folders(recorded_run):
    return [recorded_run(text) / "run" for text in (ONE, OTHER)]


@pytest.fixture(scope="module")
def file(folders, tmp_path_factory):
    file = tmp_path_factory.mktemp("page") / "new" / "compare.html"
    assert main(["compare", *map(str, folders), "--page", str(file)]) == 1
    return file


@pytest.fixture(scope="module")
def shared(browser, file):
    with visits(browser) as visit:
        yield visit(file, width=1440, height=900)


@pytest.fixture
def page(shared):
    shared.page.keyboard.press("Home")
    return shared.page


def test_the_page_lists_what_differs_and_where_the_runs_part(page, folders):
    assert page.inner_text("header .pill") == "DIFFERENT"
    assert page.locator("header .pill.bad").count() == 0, "a difference is no failure"
    text = page.inner_text("#panel-differences")
    assert "joint1: 0.6" in text
    assert "joint1: 1.2" in text
    assert "Where they part" in text
    page.click("section:has(h3:text-is('Where they part')) .link >> nth=0")
    first, second = (read_run(folder).run.signals for folder in folders)
    time = float(page.get_attribute("#track", "aria-valuenow"))
    row = round(time / (first.times[1] - first.times[0]))
    assert (first.joint_commands[: row + 1] != second.joint_commands[: row + 1]).any()


STRICTER = ONE.replace("10 s", "1 s")
FALLS = """\
scenario: a ball falls
robot: open_manipulator_x
objects: [{name: ball, sphere: {radius: 2 cm}, pose: {xyz: [0.4, 0, 20 cm]}, mass: 0.1}]
steps: [{wait: 0.2}]
expect: [{duration: {at_most: 1 s}}]
"""


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(
    ("one", "other", "outcome", "sentences"),
    [
        (ONE, STRICTER, "failed", [
            "B misses “duration is at most 10.0 → 1.0 s”, which A meets.",
            "In the file: duration: {at_most: 1 s} in place of duration: {at_most: 10 s}.",
            "The recorded motion is the same.",
        ]),
        (FALLS, FALLS.replace("20 cm", "35 cm"), "passed", [
            "Every expectation has the same outcome in both runs: both passed.",
            "in place of",
            "ball is elsewhere, by up to 150 mm; the arm moves the same throughout.",
        ]),
    ],
)  # fmt: skip
def test_the_headline_says_what_turned_its_cause_and_what_moved(
    visit, recorded_run, tmp_path, one, other, outcome, sentences
):
    runs = [recorded_run(one) / "run", recorded_run(other, outcome=outcome) / "run"]
    assert main(["compare", *map(str, runs), "--page", str(tmp_path / "compare.html")]) == 1
    page = visit(tmp_path / "compare.html").page
    found = page.locator("#headline dd").all_inner_texts()
    assert all(part in text for part, text in zip(sentences, found, strict=True)), found
    turned = page.locator(".verdict-pairs .turned")
    assert turned.count() == (outcome == "failed")
    if turned.count():
        assert turned.locator("td .sign").evaluate_all(
            "all => all.map((each) => each.ariaLabel)"
        ) == ["passed", "failed"]
        assert [*turned.locator("td").all_inner_texts()][2].endswith("9.00 s")
        [step] = page.locator("#steps .step.differs").all_inner_texts()
        assert "passed → failed" in step, "the step in which it was missed"
    else:
        assert page.input_value(".plot select >> nth=0") == "apart"


def test_headline_mark_and_key_have_the_time_at_which_people_see_a_difference(page, folders):
    since = float(re.search(r"From t = ([\d.]+) s", page.inner_text("#headline"))[1])
    page.keyboard.press("n")
    assert float(page.get_attribute("#track", "aria-valuenow")) == pytest.approx(since, abs=6e-3)
    assert page.get_attribute(".mark", "title").startswith("the runs come apart")
    links = page.locator("section:has(h3:text-is('Where they part')) .link").all_inner_texts()
    assert f"is elsewhere from t = {since:.2f} s on" in links[0]
    assert links[-1].startswith("numerically apart, first in step turn")
    first = compare(*map(read_run, folders)).first_difference
    assert first.time < since


def test_steps_are_aligned_and_a_new_one_stands_alone(page):
    steps = page.locator("#steps .step")
    assert steps.count() == 4
    assert steps.nth(0).inner_text().startswith("turn")
    assert "only in B" in steps.nth(1).inner_text()
    assert [each.get_attribute("class") for each in steps.all()][2:] == [
        "step same",
        "step differs",
    ]


@pytest.mark.nightly
def test_both_robots_are_drawn_over_and_next_to_each_other(visit, file):
    page = visit(file, width=1440, height=900, has_scene=True).page
    page.click("#steps .step >> nth=2")
    both = picture(page)
    page.click("#switches button >> nth=1")
    alone = picture(page)
    assert abs(both - alone).max() > 20, "the second robot is gone"
    page.click("#switches button >> nth=1")
    page.click("#switches button:text-is('side by side')")
    halves = picture(page)
    assert abs(halves - both).mean() > 2
    assert halves[:, :32].std() > 5
    assert halves[:, 32:].std() > 5
    page.click("#switches button:text-is('side by side')")
    assert abs(picture(page) - both).max() == 0


@pytest.mark.nightly
def test_aligned_steps_begin_at_the_same_place_of_the_clock(page):
    places = """[0, 1].map(row => [...document.querySelectorAll('.band')]
      .filter(band => band.style.getPropertyValue('--row') === String(row))
      .filter(band => band.title.includes('wait'))
      .map(band => Math.round(band.offsetLeft))[0])"""
    apart = page.evaluate(places)
    assert apart[0] < apart[1], "the second run has a step more"
    page.click("#switches button:text-is('steps aligned')")
    wait_for_frame(page)
    one, two = page.evaluate(places)
    assert abs(one - two) <= 1
    page.click("#switches button:text-is('steps aligned')")
    assert page.evaluate(places) == apart


@pytest.mark.nightly
def test_plots_show_both_runs(page):
    page.select_option(".plot select >> nth=0", "position")
    names = page.locator(".legend button").all_inner_texts()
    assert names.count("joint1") == 1, "one entry for both lines of a joint"
    assert "joint2" not in names, "lines that are over each other are left out"
    canvas = page.locator(".plot canvas").first
    with page.expect_download() as saved:
        page.click(".plot button:text-is('SVG') >> nth=0")
    assert Path(saved.value.path()).read_text().count('stroke-dasharray="5 3"') == 1
    before = canvas.screenshot()
    page.click(".legend button >> nth=0")
    assert canvas.screenshot() != before
    page.click(".legend button >> nth=0")


def test_a_telephone_and_no_scripts_show_the_differences(browser, file):
    with visits(browser) as visit:
        narrow = visit(file, width=390, height=800).page
        [opened] = re.findall(r"TCP is farthest apart at t=([\d.]+)", narrow.content())
        assert narrow.get_attribute("#track", "aria-valuenow") == f"{float(opened):.3f}"
        assert narrow.evaluate("document.documentElement.scrollWidth") <= 390
        assert narrow.evaluate("document.querySelector('#details').offsetWidth") > 370
        plain = visit(file, scripts=False)
        assert "joint1: 1.2" in plain.text("#summary")


def test_equal_runs_have_no_page_but_on_request(folders, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    run = str(folders[0])
    assert main(["compare", run, run]) == 0
    assert list(tmp_path.iterdir()) == []
    assert main(["compare", run, run, "--page", "same.html"]) == 0
    assert "page: same.html" in capsys.readouterr().out
    assert ">SAME<" in (tmp_path / "same.html").read_text()
    assert main(["compare", *map(str, folders), "--json"]) == 1
    assert main(["compare", *map(str, folders), "--no-page"]) == 1
    assert not (tmp_path / "reports").exists()
    (tmp_path / "file").write_text("")
    assert exit_code("compare", *folders, "--page", "file/a.html") == 2


@pytest.mark.parametrize(
    ("one", "two", "pairs"),
    [
        ("abc", "abc", [(0, 0), (1, 1), (2, 2)]),
        ("abc", "xabc", [(None, 0), (0, 1), (1, 2), (2, 3)]),
        ("abc", "ac", [(0, 0), (1, None), (2, 1)]),
        ("abc", "aXc", [(0, 0), (1, 1), (2, 2)]),
        ("ab", "", [(0, None), (1, None)]),
    ],
)  # fmt: skip
def test_steps_are_aligned_by_id_and_content_and_not_by_place(one, two, pairs):
    """Upper case is another step of the same kind; x is of another kind."""

    def run(letters):
        made = [
            step(
                f"id_{letter}", number, number + 1,
                verb="other" if letter == "x" else letter.lower().replace("x", "b"),
            )
            for number, letter in enumerate(letters)
        ]  # fmt: skip
        return make_run(steps=tuple(made))

    ours, theirs = run(one), run(two)
    places = [
        tuple(
            None if each is None else run.steps.index(each)
            for each, run in zip(pair, (ours, theirs), strict=True)
        )
        for pair in aligned_steps(ours, theirs)
    ]
    assert places == pairs


def test_a_step_without_an_id_is_named_by_what_it_does(folders):
    first, second = (read_run(folder) for folder in folders)
    steps = [change for change in compare(first, second).changes if change.what == "step"]
    assert [(each.name, each.before, each.after) for each in steps] == [
        ("turn", "ptp joints 34.38 deg", "ptp joints 68.75 deg"),
        ("gripper closed", "-", "passed"),
    ]


@pytest.mark.parametrize(
    ("one", "two", "names"),
    [
        ("/a/b/c", "/a/d/c", ("b", "d")),
        ("/a/b", "/a/c", ("b", "c")),
        ("/a/b", "/a/b", ("b", "b")),
        ("/a/b/x/y", "/a/c/y", ("b/x", "c")),
    ],
)
def test_folders_are_named_by_what_differs(one, two, names):
    assert distinct_parts(Path(one), Path(two)) == names


def test_a_step_that_lasted_longer_differs(page):
    signs = page.locator("#steps .step").evaluate_all(
        "rows => rows.map((row) => [...row.querySelectorAll('.took')].map((each) => each.innerText)"
        ".concat(row.querySelector('.equality').ariaLabel))"
    )
    assert any(one != two for one, two, _ in signs)
    assert all(sign == "differs" for one, two, sign in signs if one != two)
