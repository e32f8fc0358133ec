"""The studio in a real browser: one robot, from the first slider to a saved scenario."""

import re
from contextlib import closing

import numpy as np
import pytest

from docs.generators.studio_guide import follow, is_shown, steps
from harness.plugins.studio.document import new_text
from harness.session.run_case import run_case
from harness.session.run_request import RunRequest
from tests.reporting.browser import NO_WEBGL, new_context, wait_for
from tests.waiting import wait_for as wait

pytest.importorskip("django_static_ace_builds")

EXPECTED_NOISE = "WebGL|GPU stall"


COMPLETE = """
const editor = ace.edit("editor");
editor.find("move_to: ");
editor.clearSelection();
editor.focus();
editor.execCommand("startAutocomplete");
"""


class Page:
    """A page of the studio, with what went wrong in it."""

    def __init__(self, context, address, *, has_scene=False, is_live=True):
        self.page = context.new_page()
        if not has_scene:  # drawn in software, it takes longer than all the rest
            self.page.add_init_script(NO_WEBGL)
        self.complaints = []
        self.page.on("console", self._hear)
        self.page.on("pageerror", self._hear_error)
        self.page.goto(address)
        if is_live:
            self.wait("document.querySelectorAll('.joint').length > 0")

    def _hear(self, message):
        if message.type == "error" and not re.search(EXPECTED_NOISE, message.text):
            self.complaints.append(message.text)

    def _hear_error(self, error):
        self.complaints.append(str(error))

    def wait(self, expression):
        wait_for(self.page, expression)

    def wait_text(self, selector, text):
        self.wait(f"document.querySelector({selector!r}).innerText.includes({text!r})")

    def editor(self):
        return self.page.evaluate("ace.edit('editor').getValue()")

    def type_scenario(self, text):
        self.page.evaluate("text => ace.edit('editor').setValue(text, -1)", text)


@pytest.fixture(scope="module")
def served(serve):
    return serve()


@pytest.fixture(scope="module")
def picked(browser, serve):
    """A page on which the guide's pick was done by hand, and its studio."""
    served = serve()
    context = new_context(browser, viewport={"width": 1400, "height": 900})
    page = Page(context, served.address)
    page.page.select_option("#speed", "0")
    for _, sentences in steps():
        for sentence in sentences:
            shown = follow(page.page, sentence)
            if shown:
                page.wait(is_shown(shown))
    yield page, served
    assert page.complaints == []
    context.close()


@pytest.fixture(scope="module")
def opened(browser, served):
    context = new_context(browser, viewport={"width": 1400, "height": 900})
    page = Page(context, served.address)
    page.page.select_option("#speed", "0")
    yield page
    assert page.complaints == []
    context.close()


MEASURED = "Number(document.querySelector('[data-joint=joint1] input[type=number]').value)"


def test_a_number_moves_the_joint_in_the_units_of_the_page(opened, served):
    opened.page.fill('input[aria-label="joint1 number"]', "22.9")
    opened.page.press('input[aria-label="joint1 number"]', "Enter")
    opened.wait_text("#status", "moved by hand")
    wait(lambda: abs(served.studio.cell.joint_positions()[0] - 0.4) < 0.01)
    opened.page.evaluate("document.activeElement.blur()")
    opened.page.click("#reset")
    opened.wait(f"Math.abs({MEASURED}) < 0.5")


@pytest.mark.nightly
def test_buttons_nudge_a_joint_by_a_degree(opened, served):
    opened.page.click('button[aria-label="joint2 more"]')
    opened.page.click('button[aria-label="joint2 more"]', modifiers=["Shift"])
    wait(lambda: abs(served.studio.cell.joint_positions()[1] - np.radians(11)) < 5e-3)
    opened.page.click("#reset")


def test_a_slider_is_coloured_near_its_limits(opened):
    def classes(value):
        slider = f"document.querySelector('input[aria-label=joint3]').value = {value}"
        event = ".dispatchEvent(new Event('input'))"
        opened.page.evaluate(f"{slider}; document.querySelector('input[aria-label=joint3]'){event}")
        return opened.page.get_attribute("[data-joint=joint3]", "class")

    low, high = (float(opened.page.get_attribute("input[aria-label=joint3]", e)) for e in ENDS)
    assert classes(0.5 * (low + high)) == "joint"
    assert classes(low + 0.03 * (high - low)) == "joint near"
    assert classes(high) == "joint at-limit"
    background = "getComputedStyle(document.querySelector('.track'), '::before').backgroundImage"
    assert "linear-gradient" in opened.page.evaluate(background), "limits are drawn on the track"
    opened.page.click("#reset")


ENDS = ("min", "max")


def test_the_first_minute_a_slider_execute_and_run_all(browser, serve):
    """With the real mouse on the real slider, and the keys while it has the focus."""
    served = serve()
    context = new_context(browser, viewport={"width": 1400, "height": 900})
    page = Page(context, served.address)
    page.page.select_option("#speed", "0")
    box = page.page.locator("input[aria-label=joint1]").bounding_box()
    page.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.page.mouse.down()
    page.page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + box["height"] / 2, steps=4)
    page.page.mouse.up()
    page.wait_text("#status", "moved by hand")
    page.page.click("#execute")
    page.wait_text("#status", "1 of 1 steps executed, from where the arm was moved by hand")
    assert "move_to: {joints: {joint1: " in page.editor()
    page.page.focus("input[aria-label=joint1]")
    page.page.keyboard.press("o")
    page.wait_text("#status", "2 of 2 steps executed")
    page.page.keyboard.press("p")
    page.wait_text("#status", "3 of 3 steps executed")
    page.page.click("#back")
    page.wait_text("#status", "2 of 3 steps executed")
    page.page.evaluate("ace.edit('editor').gotoLine(1000)")
    page.page.click("#run-line")
    page.wait_text("#status", "3 of 3 steps executed")
    page.page.click("#run-all")
    page.wait_text("#verdicts", "digest")
    assert "passed" in page.page.get_attribute(".outcome", "class")
    assert page.page.inner_text("#status") == "3 of 3 steps executed"
    text = page.editor()
    line = 1 + text.splitlines().index(next(each for each in text.splitlines() if "- " in each))
    assert page.page.locator(".verdict .line").first.inner_text() == f"line {line}"
    page.page.click("#execute")
    page.wait_text("#log", "there is no goal: move a joint")
    assert page.editor() == text
    assert page.complaints == []
    context.close()


@pytest.mark.nightly
@pytest.mark.parametrize("focus", ['input[aria-label="joint1"]', "#record"])
def test_keys_move_the_gripper_while_a_slider_or_a_box_to_tick_has_the_focus(browser, serve, focus):
    """Sliders have it after each drag; then a recorded step and the whole scenario run."""
    served = serve()
    context = new_context(browser, viewport={"width": 1400, "height": 900})
    page = Page(context, served.address)
    page.page.select_option("#speed", "0")
    slider = page.page.locator('input[aria-label="joint1"]')
    slider.focus()
    slider.press("ArrowRight")
    page.wait_text("#status", "moved by hand")
    page.page.focus(focus)
    page.page.keyboard.press("o")
    page.wait_text("#status", "1 of 1 steps executed")
    page.page.click("#run-all")
    page.wait_text("#verdicts", "digest")
    assert served.studio.cell.is_run
    assert page.complaints == []
    context.close()


def test_an_overlap_is_shown_and_physics_waits_before_it_pushes_bodies_apart(opened, served):
    size, xyz = [0.04, 0.04, 0.04], [0.2, 0, 0.01]
    assert served.reply_to("add_object", name="sunk", kind="box", size=size, xyz=xyz) == {}
    opened.wait_text("#overlaps", "At the start ground_plane and sunk overlap by 10.0 mm")
    opened.wait("document.getElementById('play').ariaLabel === 'Play'")
    assert opened.page.inner_text("#clock") == "0.000 s"
    assert served.studio.cell.object_poses()["sunk"].translation[2] == pytest.approx(0.01)
    opened.page.click("#play")
    opened.wait("document.getElementById('overlaps').hidden")
    served.reply_to("delete_object", name="sunk")


def test_a_value_beyond_the_limit_is_refused(opened):
    opened.page.fill('input[aria-label="joint1 number"]', "600")
    opened.page.press('input[aria-label="joint1 number"]', "Enter")
    opened.wait_text("#log", "joint1 goes from -180.0 to 180.0°, not to 600.0°")


@pytest.mark.nightly
def test_the_pick_of_the_guide_becomes_a_scenario_with_the_same_digest(picked):
    opened, served = picked
    shown = opened.page.get_attribute(".outcome", "data-digest")
    assert served.files.path.read_text() == opened.editor()
    result = run_case(RunRequest(served.files.path))
    assert (result.outcome, result.digest) == ("passed", shown)
    assert [verdict.status for verdict in result.verdicts] == ["passed"] * len(result.verdicts)
    assert served.studio.cell.object_poses()["box"].translation[2] > 0.09


@pytest.mark.nightly
def test_one_step_back_and_to_the_cursor(picked):
    opened, served = picked
    opened.page.click("#back")
    opened.wait_text("#status", "4 of 5 steps executed")
    opened.page.evaluate("ace.edit('editor').gotoLine(1000)")
    opened.page.click("#run-line")
    opened.wait_text("#status", "5 of 5 steps executed")
    assert served.studio.cell.is_run


@pytest.mark.nightly
def test_a_breakpoint_stops_before_its_step(picked):
    opened, _ = picked
    opened.page.click("#reset")
    opened.wait_text("#status", "0 of 5 steps executed")
    opened.page.click(".ace_gutter-cell:has-text('10')")
    opened.page.click("#run-breakpoint")
    opened.wait_text("#status", "2 of 5 steps executed")
    opened.page.evaluate("ace.edit('editor').gotoLine(11)")
    opened.page.keyboard.press("F9")
    opened.page.keyboard.press("F5")
    opened.wait_text("#status", "3 of 5 steps executed")
    opened.page.keyboard.press("F5")
    opened.wait_text("#status", "5 of 5 steps executed")


@pytest.mark.parametrize(("width", "shown"), [(1440, True), (1024, False)])
def test_every_icon_of_the_toolbars_has_its_word_or_a_tooltip(opened, width, shown):
    opened.page.set_viewport_size({"width": width, "height": 900})
    labels = opened.page.locator(".tools .icon, #save").evaluate_all(
        "all => all.map((each) => [each.ariaLabel, getComputedStyle(each, '::after').content,"
        " each.title])"
    )
    assert len(labels) == 9
    for label, drawn, title in labels:
        assert (drawn == f'"{label}"') == shown, label
        assert len(title) > len(label), "the tooltip says more"
    assert opened.page.evaluate("document.documentElement.scrollWidth") <= width


@pytest.mark.nightly
def test_the_mark_of_an_executed_step_stays_with_its_line(browser, serve):
    """Also while nothing moves, and lines above it are added or removed."""
    with closing(new_context(browser)) as context:
        written = "scenario: mark\nrobot: open_manipulator_x\nsteps:\n  - wait: 1 ms\n"
        page = Page(context, serve(written).address)
        page.page.click("#run-next")
        page.wait_text("#status", "1 of 1 steps executed")
        page.page.click("#play")  # nothing comes from the cell any more
        page.wait("document.querySelector('#play').ariaPressed === 'false'")
        for text, line in (("# a comment\n" * 2, 6), ("", 4)):
            page.type_scenario(text + written)
            marked = "document.querySelector('.ace_gutter-cell.done')?.innerText.trim()"
            page.wait(f"{marked} === '{line}'")
            assert page.page.locator(".ace_gutter-cell.done").count() == 1


@pytest.mark.nightly
def test_a_mistake_is_marked_at_its_place_with_advice(opened):
    good = opened.editor().replace("steps: []", "steps:\n  - gripper: open")
    opened.type_scenario(good.replace("gripper: open", "gripper: opne"))
    opened.wait("document.querySelectorAll('#problems button').length === 1")
    problem = opened.page.inner_text("#problems")
    assert re.match(r"\d+:\d+: there is no named state of gripper called 'opne'", problem)
    assert "did you mean `open`" in problem
    [annotation] = opened.page.evaluate("ace.edit('editor').session.getAnnotations()")
    assert "opne'" in annotation["text"]
    opened.page.click("#run-all")
    opened.wait_text("#log", "has mistakes")
    opened.type_scenario(good)
    opened.wait("document.querySelectorAll('#problems button').length === 0")


def test_completion_offers_what_the_robot_has(opened):
    page = opened.page
    good = opened.editor().replace("steps: []", "steps:\n  - gripper: open")
    opened.type_scenario(good.replace("gripper: open", "move_to: ", 1))
    page.evaluate(COMPLETE)
    opened.wait("document.querySelector('.ace_autocomplete')?.innerText.includes('home')")
    page.keyboard.press("Escape")
    opened.type_scenario(good)
    opened.wait("document.querySelectorAll('#problems button').length === 0")


@pytest.mark.nightly
def test_the_field_of_a_step_is_completed(opened):
    opened.page.click("#show-objects")

    def offered(text):
        opened.page.fill("#step-text", text)
        opened.wait(f"[...document.querySelectorAll('#continuations option')].some({starts(text)})")
        return opened.page.evaluate(OFFERED)

    assert {"pick: ", "place: ", "wait: "} <= set(offered(""))
    assert "place: {object: x, pose: " in offered("place: {object: x, ")
    assert "move_to: home" in offered("move_to: ")
    opened.page.fill("#step-text", "")
    opened.page.click("#show-arm")


OFFERED = "[...document.querySelectorAll('#continuations option')].map((each) => each.value)"


def starts(text):
    return f"(each) => each.value !== {text!r} && each.value.startsWith({text!r})"


VISIBLE = """
[...document.querySelectorAll("button, input, select, summary, textarea")].filter((e) =>
  e.checkVisibility() && !e.closest(".ace_search") && !e.closest(".ace_editor.ace_autocomplete"))
"""
NAMED = "e.innerText || e.ariaLabel || e.title || [...(e.labels ?? [])].map((l) => l.innerText)[0]"
REACHED = "reached.add(document.activeElement) && document.activeElement.tagName"
COLORS = "(({color, backgroundColor}) => [color, backgroundColor])(getComputedStyle(document.body))"


@pytest.mark.nightly(but=["objects"])
@pytest.mark.parametrize("tab", ["arm", "objects", "sensors"])
def test_every_control_is_reached_with_the_tab_key_and_has_a_name(opened, tab):
    page = opened.page
    page.click(f"#show-{tab}")
    page.evaluate("document.querySelectorAll('details').forEach((each) => { each.open = true; })")
    assert page.evaluate(f"{VISIBLE}.filter((e) => !({NAMED})).map((e) => e.outerHTML)") == []
    page.evaluate("window.reached = new Set(); document.activeElement.blur()")
    for _ in range(page.evaluate(f"{VISIBLE}.length") + 10):
        page.keyboard.press("Tab")
        if page.evaluate(REACHED) == "TEXTAREA":
            page.keyboard.press("Escape")  # the Tab key indents the text
    assert page.evaluate(f"{VISIBLE}.filter((e) => !reached.has(e)).map((e) => e.outerHTML)") == []
    page.click("#show-arm")


SIZES = [(1440, 900), (1024, 700), (760, 700), (390, 800)]
IS_SEEN = """
["plan", "execute", "stop"].every((id) => {
  const box = document.getElementById(id).getBoundingClientRect();
  return id === "stop" && innerWidth < 900 // it scrolls away on a phone; Escape stops there too
    || box.top >= 0 && box.bottom <= innerHeight && box.right <= innerWidth;
})
"""
CUT = """
[...document.querySelectorAll("button, label, h1, h2, .joint span, .object span")].filter((e) =>
  e.checkVisibility() && e.clientWidth && e.scrollWidth > e.clientWidth + 1).map((e) => e.outerHTML)
"""

NUMBERS_CUT = """
[...document.querySelectorAll('#pose .axis')].filter((axis, index) => {
  const input = axis.querySelector('input'), before = input.value;
  input.value = index < 3 ? '-1234.5' : '-179.9';
  const isCut = input.scrollWidth > input.clientWidth;
  input.value = before;
  return isCut;
}).map((axis) => axis.textContent)
"""


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize("size", SIZES, ids=str)
def test_plan_and_execute_stay_on_the_screen_and_no_name_is_cut(opened, size):
    page = opened.page
    page.set_viewport_size({"width": size[0], "height": size[1]})
    assert page.evaluate("document.documentElement.scrollWidth") == size[0]
    for tab in ("sensors", "objects", "arm"):
        page.click(f"#show-{tab}")
        assert page.evaluate(IS_SEEN), tab
        assert page.evaluate(CUT) == []
    assert page.evaluate(NUMBERS_CUT) == []
    inner = "document.querySelector('{}').getBoundingClientRect().right".format
    assert page.evaluate(inner("#frame")) <= page.evaluate(inner("#tab-arm"))
    page.set_viewport_size({"width": 1400, "height": 900})


LONG = "a reason that has to be read to its end, as long as those of a planner are; " * 4
IS_WHOLE = "(box => box.scrollHeight <= box.clientHeight)(document.getElementById('plan-result'))"


def test_a_long_reason_is_shown_whole_and_the_buttons_stay(opened):
    page = opened.page
    page.set_viewport_size({"width": 1024, "height": 700})
    page.evaluate(f"document.getElementById('plan-result').textContent = {LONG!r}")
    assert page.evaluate(IS_WHOLE)
    assert page.evaluate(IS_SEEN)
    page.evaluate("document.getElementById('plan-result').replaceChildren()")
    page.set_viewport_size({"width": 1400, "height": 900})


def test_a_choice_that_is_longer_than_its_field_is_read_under_the_pointer(opened):
    page = opened.page
    page.hover("#verb")
    assert page.get_attribute("#verb", "title") == page.input_value("#verb")


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_phone_shows_everything_without_scrolling_sideways(opened, scheme):
    page = opened.page
    page.emulate_media(color_scheme=scheme)
    page.set_viewport_size({"width": 390, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    is_cut = "e.getBoundingClientRect().right > 391"
    assert page.evaluate(f"{VISIBLE}.filter((e) => {is_cut}).map((e) => e.outerHTML)") == []
    colors = page.evaluate(COLORS)
    light = [sum(map(int, re.findall(r"\d+", each)[:3])) > 380 for each in colors]
    assert light == ([False, True] if scheme == "light" else [True, False])
    page.set_viewport_size({"width": 1400, "height": 900})


def test_every_number_of_the_page_changes_its_unit(opened):
    opened.page.click("#show-objects")
    opened.page.fill("#object-size", "40 50 60")
    opened.page.click("#units")
    assert opened.page.input_value("#object-size") == "0.04 0.05 0.06"
    opened.page.click("#show-arm")
    assert "°" not in opened.page.inner_text("#panel")
    assert "rad" in opened.page.inner_text("#joints")
    opened.page.click("#units")
    assert opened.page.input_value("#object-size") == "40 50 60"
    assert "rad" not in opened.page.inner_text("#panel")
    assert "180°" in opened.page.inner_text("#joints")


OBJECTS = """
objects:
  - {name: post, static: true, shapes: [{box: {size: [3 cm, 3 cm, 30 cm]}}],
     pose: {xyz: [0.3, 0.3, 0.15]}}
  - {name: slab, static: true, box: {size: [0.1, 0.1, 0.02]}, pose: {xyz: [0.3, -0.3, 0.01]}}
  - {name: cube, box: {size: [5 cm, 5 cm, 5 cm]}, mass: 0.1, pose: {xyz: [0.2, 0, 0.025]}}
  - {name: plank, box: {size: [1.5, 5 cm, 2 cm]}, mass: 0.3, pose: {xyz: [0, 0.5, 0.01]}}
  - {name: tee, mass: 0.1, pose: {xyz: [0.3, 0.1, 0.05]}, shapes: [
     {box: {size: [2 cm, 2 cm, 8 cm]}}, {box: {size: [6 cm, 2 cm, 2 cm]}}]}
"""
LISTED = "[...document.querySelectorAll('#object-list .object')].map((each) => each.innerText)"


@pytest.mark.nightly
def test_the_list_of_objects_says_which_are_fixed(browser, serve):
    text = new_text("by hand", {"model": "open_manipulator_x"}, "empty")
    context = new_context(browser)
    page = Page(context, serve(text + OBJECTS).address)
    page.page.click("#show-objects")
    page.wait("document.querySelectorAll('#object-list .object').length >= 5")
    fixed = {each.split()[0]: "fixed" in each for each in page.page.evaluate(LISTED)}
    assert {name for name, is_fixed in fixed.items() if is_fixed} >= {"post", "slab"}
    assert not any(fixed[name] for name in ("cube", "plank", "tee"))
    assert page.complaints == []
    context.close()


@pytest.mark.nightly
def test_plots_count_their_time_from_now_and_contradict_no_clock(browser, serve):
    served = serve()
    context = new_context(browser)
    page = Page(context, served.address)
    page.page.evaluate("document.getElementById('plots').classList.remove('folded')")
    page.wait("(async () => (await import('/studio/plots.js')).times())()")
    first, last, *ends = page.page.evaluate("import('/studio/plots.js').then((it) => it.times())")
    assert (first, last) == (-12, 0)
    assert ends
    assert not any(ends)
    assert page.page.inner_text("#clock") == "0.000 s"
    context.close()


@pytest.mark.nightly
def test_a_second_page_watches_until_it_is_given_control(browser, opened, served):
    context = new_context(browser)
    second = Page(context, served.address)
    second.wait_text("#control-state", "you watch")
    good = opened.editor()
    opened.type_scenario(f"{good}# edited by the one that controls\n")
    second.wait("ace.edit('editor').getValue().includes('# edited')")
    opened.type_scenario(good)
    second.page.fill('input[aria-label="joint1 number"]', "11")
    second.page.press('input[aria-label="joint1 number"]', "Enter")
    second.wait_text("#log", "another page controls the cell")
    second.page.click("#control")
    opened.wait_text("#log", "Another page requests control")
    opened.page.click("#log button:has-text('Hand over')")
    second.wait_text("#control-state", "you control")
    opened.wait_text("#control-state", "you watch")
    context.close()
    opened.page.click("#control")
    opened.wait("document.getElementById('control').hidden")


def test_a_page_that_comes_back_finds_everything_as_it_was(opened):
    before = opened.editor()
    opened.page.reload()
    opened.wait("document.querySelectorAll('.joint').length > 0")
    opened.wait("document.getElementById('status').innerText.includes('steps executed')")
    assert opened.editor() == before
    assert opened.page.input_value("#speed") == "0"
    opened.wait("document.getElementById('control').hidden")


def test_a_file_with_mistakes_opens_with_its_marks_and_becomes_live(browser, serve):
    good = new_text("by hand", {"model": "open_manipulator_x"}, "empty")
    served = serve("steps: [\n")
    context = new_context(browser)
    opened = Page(context, served.address, is_live=False)
    opened.wait_text("#stand-in", "There is no robot yet")
    opened.wait_text("#problems", "not YAML")
    opened.type_scenario(good.replace("steps: []", "steps: [{move_to: hom}]"))
    opened.wait_text("#stand-in", "The robot alone")
    opened.wait_text("#problems", "did you mean `home`")
    opened.wait("document.querySelectorAll('.joint').length > 0")
    opened.type_scenario(good)
    opened.wait_text("#status", "0 of 0 steps executed")
    opened.wait("!document.querySelector('#stand-in').innerText")
    assert opened.complaints == []
    context.close()
