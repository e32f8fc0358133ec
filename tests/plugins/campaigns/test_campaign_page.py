"""The page of many samples: a map of the runs, margins, sensitivities, and drawn values."""

import random
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from harness.core.proportion import wilson_interval
from harness.plugins.campaigns.effects.campaign import campaign_of
from harness.plugins.campaigns.effects.curves import curve_of
from harness.plugins.campaigns.effects.sensitivity import sensitivities
from harness.reporting.suite.columns import Columns
from harness.reporting.suite.record import SuiteCase, SuiteRecord
from harness.reporting.suite.write import write_suite_page
from tests.reporting.suites import STUCK, failed, passed, verdict


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
  canvas.scrollIntoView({ block: "center" });
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
        "friction", "color", "x [cm]", "worst margin (share of its limit)",
    ]  # fmt: skip
    x, y = place_of(page, "failed: lifted cube; friction 0.")
    page.mouse.click(x, y)
    page.wait_for_url("**/report.html")
    assert page.title() == "one run"


@pytest.mark.nightly
def test_a_passed_run_without_a_report_is_found_in_the_table(page_file, visit):
    page = visit(page_file).page
    said = page.inner_text("#map output")
    assert re.search(r"one of the \d+ with a report", said)
    assert "--keep all writes every report" in said
    place = place_of(page, ": passed; friction")
    name = page.locator("#map output").inner_text().split(":")[0]
    page.mouse.click(*place)
    assert name in page.locator("tbody").inner_text()
    assert page.locator("tr.case").count() < 15


def test_the_failure_rate_is_shown_for_each_cell(page_file, visit):
    page = visit(page_file).page
    page.select_option("#map select[name=kind]", "rate")
    page.select_option("#map select[name=y]", label="color")
    place_of(page, "runs failed")


@pytest.mark.nightly
def test_the_map_fits_a_narrow_screen(page_file, visit):
    page = visit(page_file).page
    page.set_viewport_size({"width": 390, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_a_narrow_screen_shows_every_row_whole(page_file, visit):
    """Neither the worst margin nor the end of a reason is cut off."""
    page = visit(page_file).page
    page.set_viewport_size({"width": 390, "height": 800})
    assert page.evaluate(
        "[...document.querySelectorAll('#cases, #cases td, .why')].every("
        "each => each.scrollWidth <= each.clientWidth && each.scrollHeight <= each.clientHeight)"
    )
    page.locator("tr.case .bar").first.wait_for(state="visible")


def test_a_row_has_the_values_of_its_run(page_file, visit):
    text = visit(page_file, "#sort=number").page.locator("tr.case").first.inner_text()
    assert "friction 0.238, x 1.769 cm, color green" in text


def effects(cases):
    """File -> path -> whether it explains the failures, or the reason why that is not known."""
    return {
        each.file: {
            effect.path: effect.reason if effect.share is None else effect.is_shown
            for effect in each.effects
        }
        for each in sensitivities(Columns(cases))
    }


def in_file(name, cases):
    """The same cases in a file of another name."""
    return [replace(each, result=replace(each.result, file=name)) for each in cases]


def test_the_parameter_that_decides_is_named_alone():
    [found] = sensitivities(Columns(campaign(400)))
    assert {effect.path: effect.is_shown for effect in found.effects} == {
        "friction": True, "x": False, "color": False,
    }  # fmt: skip
    assert found.effects[0].share == pytest.approx(1)
    assert found.conclusion == "friction (lower in failed runs) explains these failures."


def with_failures(count):
    """Forty runs whose lowest frictions fail, with a parameter that does not matter."""
    rng = random.Random(1)
    rows = [{"friction": i / 40, "x": rng.random()} for i in range(40)]
    return [SuiteCase(failed(i) if i < count else passed(i), row) for i, row in enumerate(rows)]


@pytest.mark.parametrize("count", [2, 3, 10])
def test_what_fewer_than_three_failures_show_is_called_a_lead(count, tmp_path):
    cases = with_failures(count)
    [found] = sensitivities(Columns(cases))
    doubt = ": a lead, as fewer than 3 runs failed; draw more" if count < 3 else ""
    assert found.conclusion == f"friction (lower in failed runs) explains these failures{doubt}."
    text = write_suite_page(tmp_path, SuiteRecord("failed", cases)).read_text()
    assert found.conclusion in text
    assert "corrects it for the number of parameters" in text


def test_the_map_begins_with_what_explains_most():
    cases = [
        replace(
            each, values={"x": each.values["x"], "objects.cube.friction": each.values["friction"]}
        )
        for each in campaign(200)
    ]
    shown = campaign_of(Columns(cases), cases, Path())
    assert [each["name"] for each in shown.map["parameters"]] == ["friction of cube", "x"]
    assert shown.names["x"] == "x [cm]"


def test_a_curve_has_the_success_rate_and_its_interval_over_a_parameter():
    """Runs fail below a friction of a third, whatever the colour."""
    columns = Columns(campaign(160))
    friction, _, color = columns.parameters
    every = np.arange(160)
    curve = curve_of(friction, every, columns.is_good)
    rates = [1 - point.y / curve.height for point in curve.points]
    assert len(curve.points) == 8
    assert rates[:2] == [0.0, 0.0]
    assert rates[-4:] == [1.0] * 4
    assert [point.x for point in curve.points] == sorted(point.x for point in curve.points)
    for point in curve.points:
        assert point.top <= point.y <= point.bottom
    low, high = wilson_interval(20, 20, 0.95)
    assert 1 - curve.points[-1].bottom / curve.height == pytest.approx(low)
    assert curve.points[-1].text.endswith(
        f"20 of 20 passed ({low:.0%} to {high:.0%} at 95% confidence)"
    )
    words = curve_of(color, every, columns.is_good)
    assert {point.label for point in words.points} == {"red", "green"}
    assert not words.is_line


def test_where_no_run_failed_the_curve_is_of_the_worst_margin():
    cases = [SuiteCase(passed(i, 0.06 + 0.01 * (i // 10)), {"x": i // 10}) for i in range(40)]
    columns = Columns(cases)
    (x,) = columns.parameters
    curve = curve_of(x, np.arange(40), columns.is_good, np.array(columns.shares))
    heights = [point.y for point in curve.points]
    assert heights == sorted(heights, reverse=True), "margins grow with x"
    assert curve.title == "Worst margin over x"
    same = curve_of(x, np.arange(10), columns.is_good, np.array(columns.shares))
    assert same is None, "these runs do not differ in it"


def lowest(count, path):
    return lambda rows, _: sorted(range(len(rows)), key=lambda i: rows[i][path])[:count]


def at_the_ends(count, path):
    return lambda rows, _: sorted(range(len(rows)), key=lambda i: -abs(rows[i][path] - 0.5))[:count]


def often_red(rows, rng):
    return [i for i, row in enumerate(rows) if row["color"] == "red" and rng.random() < 0.7]


def less_with_friction(rows, rng):
    """The probability to fail falls with friction."""
    return [
        i for i, r in enumerate(rows) if rng.random() < 1 / (1 + np.exp(20 * r["friction"] - 6))
    ]


def any_of_them(count):
    return lambda rows, rng: rng.sample(range(len(rows)), count)


def named(seed, count, cause):
    """What explains the failures of a campaign; its margins of passed runs are random."""
    rng = random.Random(seed)
    rows = [
        {
            "friction": rng.random(), "x": rng.random(), "y": rng.random(),
            "color": rng.choice(["red", "green", "blue"]),
        }
        for _ in range(count)
    ]  # fmt: skip
    bad = set(cause(rows, rng))
    cases = [
        SuiteCase(failed(i, 0.04) if i in bad else passed(i, 0.05 + 0.02 * rng.random()), row)
        for i, row in enumerate(rows)
    ]
    [found] = sensitivities(Columns(cases))
    assert found.failures == len(bad)
    return {effect.path for effect in found.effects if effect.is_shown}


@pytest.mark.nightly(but=["<lambda>-40-friction"])
@pytest.mark.parametrize(
    ("cause", "count", "true"),
    [
        (lowest(2, "friction"), 40, "friction"),
        (lowest(10, "x"), 40, "x"),
        (at_the_ends(5, "y"), 60, "y"),
        (often_red, 60, "color"),
        (less_with_friction, 80, "friction"),
    ],
)
def test_the_cause_of_failures_is_named_in_nearly_every_campaign(cause, count, true):
    """A wrong one is named in 5 % of them; 200 campaigns have more than 20 with 0.1 %."""
    found = [named(seed, count, cause) for seed in range(200)]
    assert sum(true in each for each in found) >= 195
    assert sum(bool(each - {true}) for each in found) <= 20
    assert all(true in each or not each for each in found), "a wrong one is never named alone"


@pytest.mark.nightly
@pytest.mark.parametrize(("failures", "count"), [(1, 40), (2, 40), (10, 40), (30, 200)])
def test_failures_without_a_cause_are_explained_by_nothing(failures, count):
    found = [named(seed, count, any_of_them(failures)) for seed in range(200)]
    assert sum(map(bool, found)) <= 20


def stuck(number):
    return replace(STUCK, file="a/pick.scenario.yaml", case=f"c{number}")


def two_causes(seed, count, first, second):
    """A campaign whose runs fail by too little friction, or because the goal is too far."""
    rng = random.Random(seed)
    rows = [{name: rng.random() for name in ("friction", "x", "y", "color")} for _ in range(count)]
    slipped, far = set(first(rows, rng)), set(second(rows, rng))
    cases = [
        SuiteCase(
            stuck(i) if i in far else failed(i, 0.04) if i in slipped else passed(i, 0.06), row
        )
        for i, row in enumerate(rows)
    ]
    [found] = sensitivities(Columns(cases))
    return found


def highest(count, path):
    return lambda rows, _: sorted(range(len(rows)), key=lambda i: -rows[i][path])[:count]


def test_two_causes_are_explained_by_a_parameter_each():
    found = two_causes(3, 60, lowest(20, "friction"), highest(9, "x"))
    explained = {each.path: each for each in found.effects if each.is_shown}
    assert list(explained) == ["friction", "x"]
    assert explained["x"].causes == ("NO_IK_SOLUTION in move_to",)
    assert explained["x"].explained == 9
    assert "x (higher in failed runs) explains 9" in found.conclusion
    assert f"Of {found.failures} failures friction" in found.conclusion


@pytest.mark.nightly
@pytest.mark.parametrize("count", [40, 60])
def test_two_causes_are_named_in_nearly_every_campaign_and_no_other(count):
    found = [two_causes(s, count, lowest(15, "friction"), highest(6, "x")) for s in range(200)]
    named = [{each.path for each in one.effects if each.is_shown} for one in found]
    assert sum({"friction", "x"} <= each for each in named) >= 195
    assert sum(bool(each - {"friction", "x"}) for each in named) <= 20


@pytest.mark.nightly
def test_two_causes_of_chance_are_explained_by_nothing():
    found = [two_causes(s, 60, any_of_them(12), any_of_them(6)) for s in range(200)]
    assert sum(any(each.is_shown for each in one.effects) for one in found) <= 20


def test_margins_are_explained_where_no_run_failed():
    cases = [
        SuiteCase(passed(i, 0.06 + 0.001 * (i % 10)), {"x": i % 10, "y": i // 10})
        for i in range(50)
    ]
    [found] = sensitivities(Columns(cases))
    assert found.conclusion == "The margins are larger with larger values of x."
    alike = [SuiteCase(each.result, {"y": i // 10}) for i, each in enumerate(cases)]
    [found] = sensitivities(Columns(alike))
    assert (
        found.conclusion == "No parameter explains the margins: none has an effect beyond chance."
    )


@pytest.mark.parametrize("step", [1e-6, 1e-4])
def test_margins_that_hardly_differ_are_explained_by_nothing(step):
    """However regular they are: a curve of them is flat."""
    cases = [SuiteCase(passed(i, 0.06 + step * i), {"x": i}) for i in range(20)]
    [found] = sensitivities(Columns(cases))
    assert not any(effect.is_shown for effect in found.effects)
    assert found.conclusion.startswith("The worst margins hardly differ: 16.7% to ")


@pytest.mark.parametrize(("step", "shown"), [(1e-6, 0), (1e-3, 1)])
def test_a_page_says_that_parameters_were_tested_only_where_they_were(tmp_path, step, shown):
    cases = [SuiteCase(passed(i, 0.06 + step * i), {"x": i}) for i in range(20)]
    text = write_suite_page(tmp_path, SuiteRecord("passed", cases)).read_text()
    assert text.count("tested by permutation") == shown
    assert text.count('<svg class="curve"') == shown


def test_margins_that_are_smallest_in_the_middle_or_with_a_word_are_said_in_a_sentence():
    middle = [SuiteCase(passed(i, 0.06 + 0.001 * abs(i - 20)), {"x": i}) for i in range(41)]
    [found] = sensitivities(Columns(middle))
    assert found.conclusion == "The margins are larger towards the ends of the range of x."
    kinds = ("box", "ball", "cone")
    words = [
        SuiteCase(passed(i, 0.06 + 0.01 * (i % 3)), {"object": kinds[i % 3]}) for i in range(40)
    ]
    [found] = sensitivities(Columns(words))
    assert found.conclusion == "The margins are smallest with the value box of object."


def test_a_parameter_is_judged_among_the_runs_of_the_files_that_have_it():
    """Another file's parameters and margins change nothing."""
    other = in_file(
        "b.yaml", [SuiteCase(passed(i, 10.0 * i), {"model": "ur5e"}) for i in range(1, 40)]
    )
    alone = effects(in_file("a.yaml", campaign(100)))["a.yaml"]
    both = effects(in_file("a.yaml", campaign(100)) + other)
    assert both == {"a.yaml": alone, "b.yaml": {}}


@pytest.mark.nightly
def test_too_few_runs_of_a_file_are_no_share_of_zero(tmp_path, visit):
    cases = in_file("a.yaml", campaign(7)) + in_file("b.yaml", campaign(30))
    assert effects(cases)["a.yaml"] == {}
    section = visit(write_suite_page(tmp_path, SuiteRecord("failed", cases))).page.locator(
        ".effects"
    )
    assert "Too few runs, fewer than 8 of a file: a.yaml (7)" in section.inner_text()
    assert section.locator("li").count() == 3
    assert section.locator("svg.curve").count() == 3


def test_what_cannot_be_known_has_a_reason_and_no_share():
    one_each = [SuiteCase(passed(i, 0.05 + i), {"word": f"w{i}"}) for i in range(8)]
    assert effects(one_each)["a/pick.scenario.yaml"] == {"word": "too few runs: 8"}
    same = [SuiteCase(passed(i), {"x": i}) for i in range(9)]
    assert effects(same)["a/pick.scenario.yaml"] == {"x": "every run has the same worst margin"}
    rare = [SuiteCase(passed(i, 0.05 + i), {"x": i} if i < 5 else {"y": 1}) for i in range(20)]
    assert effects(rare)["a/pick.scenario.yaml"] == {"x": "too few runs: 5"}


def test_runs_that_fail_without_a_margin_count_with_their_outcome():
    """Half of the runs end at a step that fails: the parameter that decides so is found."""
    cases = [
        SuiteCase(
            replace(STUCK, file="a.yaml") if far else passed(i, 0.06 + 0.001 * i), {"far": far}
        )
        for i, far in enumerate([0, 1] * 10)
    ]
    [found] = sensitivities(Columns(in_file("a.yaml", cases)))
    assert found.measured == "outcome"
    assert found.effects[0].share == pytest.approx(1)
    assert found.effects[0].words == "higher in failed runs"


def margins(tmp_path, visit, cases):
    """The texts of the panels of margins."""
    page = visit(write_suite_page(tmp_path, SuiteRecord("failed", cases))).page
    return page.locator(".margins figcaption, .margins p").all_inner_texts()


def grasped(number, margin, unit):
    """A run whose grasp is judged in newtons where it failed, and in metres where it slipped."""
    status = "failed" if margin < 0 else "passed"
    judged = replace(verdict(0.06), expectation="grasped", status=status, margin=margin, unit=unit)
    result = replace(passed(number), outcome=status, verdicts=(verdict(0.06 + number), judged))
    return SuiteCase(result, {"mass": number})


@pytest.mark.nightly(but=[1])
@pytest.mark.parametrize("slips", [1, 6])
def test_failures_that_are_all_alike_have_a_panel_in_their_unit(tmp_path, visit, slips):
    cases = [grasped(i, -0.05, "N") for i in range(8)]
    cases += [grasped(i, 0.001 + 1e-5 * i, "m") for i in range(8, 8 + slips)]
    texts = margins(tmp_path, visit, cases)
    assert texts[0].startswith("grasped\n8 margins, all -0.05 N; 8 below zero")
    assert any(f"{slips} margins, from 1.1 mm to 1.1 mm" in each for each in texts) == (slips > 1)


@pytest.mark.nightly
def test_one_failure_alone_in_its_unit_is_a_sentence(tmp_path, visit):
    cases = [grasped(i, 0.001 + 1e-5 * i, "m") for i in range(8)] + [grasped(8, -0.05, "N")]
    page = visit(write_suite_page(tmp_path, SuiteRecord("failed", cases))).page
    panel = page.locator(".margins figure", has_text="of -0.05 N")
    assert "grasped\n1 margin, of -0.05 N; 1 below zero" in panel.inner_text()
    assert panel.locator("svg").count() == 0


def test_the_panels_of_an_expectation_stand_next_to_each_other(tmp_path, visit):
    cases = [grasped(i, -0.05, "N") for i in range(8)]
    cases += [grasped(i, 0.001 + 1e-5 * i, "m") for i in range(8, 12)]
    names = [each.split("\n")[0] for each in margins(tmp_path, visit, cases)]
    assert names == ["grasped", "grasped", "lifted cube"]


@pytest.mark.nightly
def test_failures_without_a_margin_are_counted(tmp_path, visit):
    cases = [SuiteCase(passed(i, 0.06 + 0.01 * i), {"x": i}) for i in range(8)]
    unknown = replace(verdict(0.03), margin=float("nan"))
    cases += [SuiteCase(replace(failed(8), verdicts=(unknown,)), {"x": 8})] * 2
    assert "lifted cube: 2 more failed without a margin" in margins(tmp_path, visit, cases)


def test_the_map_says_which_runs_have_no_place_on_its_axes(tmp_path, visit):
    """The legend names the causes of the points that are drawn, and of no others."""
    stuck = [SuiteCase(STUCK, {"model": name}) for name in ("ur3e", "ur5e")] * 2
    page = visit(write_suite_page(tmp_path, SuiteRecord("failed", campaign(20) + stuck))).page
    legend = page.locator("#map .legend")
    assert "4 of 24 runs have no such values and are not drawn" in legend.inner_text()
    assert "NO_IK_SOLUTION" not in legend.inner_text()
    for axis in "xy":
        page.select_option(f"#map select[name={axis}]", "3")
    assert "20 of 24 runs have no such values" in legend.inner_text()
    assert "NO_IK_SOLUTION in move_to" in legend.inner_text()


@pytest.mark.nightly
def test_a_page_of_many_samples_stays_small(tmp_path):
    page = write_suite_page(tmp_path, SuiteRecord("failed", campaign(20_000)))
    text = page.read_text()
    assert len(text) < 5_000_000
    assert "10000 of 20000 runs are drawn" in text
    assert "10000 more cases are not listed" in text


def test_hostile_words_stay_text(tmp_path, visit):
    words = ("</script><script>document.title = 'taken over'</script>", "<b>bold</b>")
    page = write_suite_page(tmp_path, SuiteRecord("failed", campaign(20, words)))
    seen = visit(page)
    assert "taken over" not in seen.page.title()
    seen.page.select_option("#map select[name=y]", label="color")
    assert seen.complaints == []


def test_few_runs_and_runs_without_variation_have_no_map(tmp_path):
    for cases in (campaign(4), [SuiteCase(passed(i)) for i in range(50)]):
        assert campaign_of(Columns(cases), cases, tmp_path) is None


def test_the_keys_go_through_the_runs_of_the_map(page_file, visit):
    page = visit(page_file).page
    canvas = page.locator("#map canvas")
    canvas.focus()
    said = set()
    for _ in range(3):
        page.keyboard.press("ArrowRight")
        said.add(page.inner_text("#map output"))
    assert len(said) == 3
    page.keyboard.press("ArrowLeft")
    assert page.inner_text("#map output") in said
    assert "friction" in page.inner_text("#map output")


def test_the_curve_of_a_parameter_leaves_out_runs_that_failed_for_another_cause():
    rng = random.Random(3)
    rows = [{"friction": rng.random(), "x": rng.random()} for _ in range(60)]
    far = set(highest(9, "x")(rows, rng))
    slipped = set(lowest(20, "friction")(rows, rng)) - far
    cases = [
        SuiteCase(
            stuck(i) if i in far else failed(i, 0.04) if i in slipped else passed(i, 0.06), row
        )
        for i, row in enumerate(rows)
    ]
    shown = campaign_of(Columns(cases), cases, Path())
    curve = shown.curves["a/pick.scenario.yaml", "friction"]
    rates = [1 - point.y / curve.height for point in curve.points]
    assert set(rates[-4:]) == {1.0}, "all that failed there were too far away"
