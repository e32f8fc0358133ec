"""What the page of a failed run says first: its cause, the fault before it, and the command."""

import shlex
from dataclasses import replace

import pytest

from harness.recording.run import Finding
from harness.recording.stored_run import StoredRun
from harness.recording.verdict import Measure, Verdict
from harness.reporting.html.story import findings_facts
from harness.reporting.html.write import Page
from tests.judging.synthetic_run import at, make_run, step
from tests.reporting.browser import wait_for_frame

STEPS = (
    step("home", 0, 60),
    replace(step("slip", 60, 60, "inject"), summary="inject friction of box 0.02", line=4),
    replace(step("grab", 60, 120, "pick"), summary="pick box", line=5),
    step("rest", 120, 199, "wait"),
)
LIFTED = Measure("height gained", 0.0, 0.09, ">=", "m", 0.0, "box", plot="height")
FOUND = (
    Finding("tracking", "elbow was furthest", 0.5),
    Finding("fault_without_effect", "friction had no effect", 0.6, "slip"),
)


def never_lifted(value=0.0, time=0.0):
    measures = (replace(LIFTED, value=value),)
    return Verdict(
        "box is lifted", "failed", value - 0.09, "m", time, 9, "", "it rose 0 mm", measures
    )


MISSED = Measure("position error", 0.5, 0.005, "<=", "m", 1.19,
                 expected=(0.0, 0.5, 0.0), actual=(0.0, 0.0, 0.0), plot="displacement")  # fmt: skip


def moved_off():
    return Verdict("box is placed", "failed", -0.495, "m", 1.19, 8, "grab", "elsewhere", (MISSED,))


@pytest.fixture
def opened(visit, tmp_path):
    """Opens the page of a run that failed by some verdicts."""

    def open_page(*verdicts, place="", **fields):
        run = make_run(object_poses={"box": at(200)}, steps=STEPS)
        fields = {"file": "my runs/it's.yaml", "case": "a", "versions": {"mujoco": "4"}, **fields}
        run = replace(run, **{"findings": FOUND, **fields})
        file = tmp_path / "report.html"
        stored = StoredRun(run, verdicts, "failed", "0" * 64, {})
        file.write_text(Page(run, verdicts).html(stored), encoding="utf-8")
        return visit(file, place)

    return open_page


def test_cause_fault_finding_and_command_are_at_the_top(opened):
    options = ("--set", "lift=5 cm", "--seed", "7")
    visit = opened(never_lifted(), moved_off(), options=options, source="lift: 10 cm")
    page = visit.page
    words = dict(zip(page.locator("#cause dt").all_inner_texts(),
                     page.locator("#cause dd").all_inner_texts(), strict=True))  # fmt: skip
    assert words["Cause"].startswith("box is lifted: it rose 0 mm · line 9 · 1 more")
    assert words["Fault"] == "inject friction of box 0.02 · injected at t = 0.59 s · line 4"
    assert words["Found"] == "friction had no effect"
    command = shlex.split(page.inner_text("#cause code"))
    assert command == ["harness", "run", "my runs/it's.yaml", "--case", "a", *options]
    assert "--set 'lift=5 cm' --seed 7" in page.text_content("#panel-source")
    page.click("#cause .copy")
    page.wait_for_selector(".copy:text-is('copied')")
    page.click("#cause .link:has-text('friction of box')")
    assert visit.time() == pytest.approx(0.59)
    assert page.locator("#steps .step").nth(1).get_attribute("class") == "step injected"
    assert page.locator(".band.injected").count() == 1


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(
    ("value", "time", "place", "opens"),
    [
        (0.0, 0.0, "", 1.19),
        (0.0, 0.0, "#t=0.00&expect=1", 1.19),
        (0.0, 0.8, "", 0.8),
        (0.04, 0.0, "", 0.0),
    ],
)
def test_what_never_moved_is_shown_where_it_was_to_move(opened, value, time, place, opens):
    assert opened(never_lifted(value, time), place=place).time() == pytest.approx(opens)


LOST = Finding("held", "the physics lost box at 0.90 s", 0.9, values={"held": False})


@pytest.mark.nightly(but=["verdict0-1.19-finding0", "verdict1-1.19-finding1"])
@pytest.mark.parametrize("finding", [LOST, replace(LOST, message="the physics lost cup")])
@pytest.mark.parametrize(("verdict", "judged"), [(moved_off(), 1.19), (never_lifted(), 1.19)])
def test_what_was_lost_opens_the_page_at_the_loss(opened, verdict, judged, finding):
    is_its = "box" in finding.message
    visit = opened(replace(verdict, measures=(replace(verdict.measures[0], detail="box"),)),
                   findings=(finding,))  # fmt: skip
    assert visit.time() == pytest.approx(0.9 if is_its else judged)
    visit.page.click("#panel-expect .verdict")
    was_to_move = verdict.time == 0 and is_its
    assert visit.time() == pytest.approx(0.9 if was_to_move else judged)


def test_paper_says_the_cause_first(opened):
    page = opened(never_lifted(), moved_off()).page
    assert page.text_content("#summary .why") == "Cause: box is lifted: it rose 0 mm (line 9)"


def test_what_could_not_be_observed_is_no_pass(visit, tmp_path):
    verdict = Verdict("box is grasped", "not observable", float("nan"), "N", reason="no contacts")
    run, file = make_run(steps=STEPS), tmp_path / "report.html"
    text = Page(run, (verdict,)).html(StoredRun(run, (verdict,), "passed", "0" * 64, {}))
    file.write_text(text, encoding="utf-8")
    page = visit(file, "#tab=source").page
    assert page.inner_text("header .pill") == "1 NOT OBSERVABLE"
    assert page.locator("header .pill.good").count() == 0
    facts = page.inner_text("header .facts")
    assert "recorded 2.0 s" in facts
    assert "seed" not in facts, "a recording has none"
    assert "does not hold the text" in page.inner_text("#panel-source")


@pytest.mark.nightly
def test_a_floor_is_not_used_up(opened):
    clear = Measure("clearance", 0.0127, 0.01, ">=", "m", 0.5, "box")
    held = Verdict("clearance", "passed", 0.0027, "m", 0.5, 3, "", "", (clear,))
    under = replace(clear, value=0.008, comparison="<=")
    page = opened(held, replace(held, expectation="error", margin=0.002, measures=(under,))).page
    texts = page.locator("#panel-expect .below").all_inner_texts()
    assert ["used" in text for text in texts] == [False, True]
    assert "margin 2.70 mm" in texts[0]


def test_the_first_plots_are_what_failed_with_its_limit_and_the_judged_time(opened):
    page = opened(never_lifted(), moved_off()).page
    shown = page.locator(".plot select").evaluate_all(
        "all => all.map((each) => each.selectedOptions[0].textContent)"
    )
    assert shown[:2] == [
        "rise of the lowest point [mm]",
        "position error [mm]",
    ]
    page.click("#panel-expect .verdict >> nth=1")
    wait_for_frame(page)
    assert "t = 1.19 s of 0.60 to 1.19 s" in page.inner_text("#panel-expect .verdict >> nth=1")
    with page.expect_download() as saved:
        page.click(".plot >> nth=1 >> button:text-is('SVG')")
    drawing = saved.value.path().read_text()
    assert "at most 5.00 mm" in drawing
    assert "judged" in drawing
    label = page.locator(".plot canvas").nth(1).get_attribute("aria-label")
    assert "box from 500 to 500" in label, "how far it is from where it was to be"


def test_a_recording_and_a_run_that_passed_have_no_command(opened, visit, tmp_path):
    page = opened(never_lifted(), versions={}).page
    assert page.locator("#cause .copy").count() == 0
    run = make_run(object_poses={"box": at(200)}, steps=STEPS)
    file = tmp_path / "passed.html"
    file.write_text(Page(run, ()).html(StoredRun(run, (), "passed", "0" * 64, {})))
    assert not visit(file).page.locator("#cause").is_visible()


def test_notes_are_no_warnings():
    held = (
        Finding("held", "held", values={"held": True}),
        Finding("held", "", values={"held": False}),
    )
    run = replace(make_run(), findings=(*FOUND, *held))
    assert [each["isWarning"] for each in findings_facts(run)] == [False, True, False, True]
