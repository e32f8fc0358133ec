"""The studio in a real browser: one robot, from the first slider to a saved scenario."""

import re

import numpy as np
import pytest

from docs.generators.studio_guide import follow, is_shown, steps
from harness.plugins.studio.document import new_text
from harness.session.run_case import run_case
from harness.session.run_request import RunRequest
from tests.plugins.studio.conftest import pixel_of
from tests.reporting.browser import new_context, wait_for

pytest.importorskip("viser")

EXPECTED_NOISE = "THREE.Clock|WebGL|GPU stall|Detected chrome"


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
            self.page.route("**/scene/*", lambda route: route.fulfill(body=""))
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
        if "'unsafe-eval' is not an allowed source" not in str(error):  # viser's splats, not shown
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


def test_a_slider_moves_the_joint(opened, served):
    opened.page.fill('input[aria-label="joint1 number"]', "0.4")
    opened.page.press('input[aria-label="joint1 number"]', "Enter")
    opened.wait(
        "Math.abs(parseFloat(document.querySelector('.joint output').innerText) - 22.9) < 0.5"
    )
    assert served.studio.cell.joint_positions()[0] == pytest.approx(0.4, abs=0.01)
    opened.wait_text("#status", "moved by hand")
    opened.page.click("#reset")
    opened.wait("Math.abs(parseFloat(document.querySelector('.joint output').innerText)) < 0.5")


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
    opened.wait("document.getElementById('play').innerText === 'Play'")
    assert opened.page.inner_text("#clock") == "0.000 s"
    assert served.studio.cell.object_poses()["sunk"].translation[2] == pytest.approx(0.01)
    opened.page.click("#play")
    opened.wait("document.getElementById('overlaps').hidden")
    served.reply_to("delete_object", name="sunk")


def test_a_value_beyond_the_limit_is_refused(opened):
    opened.page.fill('input[aria-label="joint1 number"]', "9")
    opened.page.press('input[aria-label="joint1 number"]', "Enter")
    opened.wait_text("#log", "joint1 goes from -3.142 to 3.142 rad, not to 9")


class Mouse:
    """Real mouse events at points of the world, in viser's picture."""

    def __init__(self, opened, served):
        self.opened, self.served = opened, served
        self.mouse, self.view = opened.page.mouse, served.studio.view
        self.phases = []
        on_drag = self.view._on_drag  # noqa: SLF001 - a drag ends when its last event has arrived

        def heard(client, phase, pose, kind):
            on_drag(client, phase, pose, kind)
            self.phases.append((phase, kind))

        self.view._on_drag = heard  # noqa: SLF001
        self.camera = wait_for_client(opened, served).camera
        self.box = opened.page.locator("#scene").bounding_box()

    def at(self, point):
        x, y = pixel_of(self.camera, (self.box["width"], self.box["height"]), point)
        return self.box["x"] + x, self.box["y"] + y

    def click_until(self, point, expression):
        """Click until the picture has what is clicked."""
        for _ in range(600):
            if self.opened.page.evaluate(expression):
                return
            self.mouse.click(*self.at(point))
            self.opened.page.wait_for_timeout(100)
        raise AssertionError(f"a click never leads to {expression}")

    def drop(self):
        """Let go, and wait until the studio has taken that in."""
        self.phases.clear()
        self.mouse.up()
        for _ in range(600):
            if any(phase == "end" for phase, _ in self.phases):
                break
            self.opened.page.wait_for_timeout(100)
        else:
            raise AssertionError("a drag never ends")
        self.served.reply_to("camera", name="")

    def drag(self, kind, axis, *distances):
        """Drag the arrow of a handle along its axis, by one distance after the other."""
        handle, arrow = self.view.handles[kind], np.eye(3)[axis]
        start = np.add(handle.position, 0.6 * handle.scale * arrow)
        self.phases.clear()
        for _ in range(20):  # until the picture has the handle
            self.mouse.move(*self.at(start))
            self.mouse.down()
            self.mouse.move(*self.at(start + 0.01 * arrow), steps=2)
            for _ in range(60):  # the start of a drag may arrive late
                self.opened.page.wait_for_timeout(50)
                if self.phases:
                    break
            if any(each == kind for _, each in self.phases):
                break
            self.mouse.up()  # nothing was hit, or a handle where it no longer is
            self.opened.page.wait_for_timeout(500)
            self.phases.clear()
        for distance in distances:
            self.mouse.move(*self.at(start + distance * arrow), steps=2)
            yield


@pytest.mark.nightly  # the picture is drawn in software
def test_handles_and_ghosts_are_used_with_the_mouse(browser, serve):
    served = serve()
    size, xyz = [0.06, 0.06, 0.06], [0.2, -0.15, 0.03]
    served.reply_to("add_object", name="box", kind="box", size=size, xyz=xyz)
    served.reply_to("handle", name="box")
    context = new_context(browser, viewport={"width": 1010, "height": 520})
    opened = Page(context, served.address, has_scene=True)
    mouse = Mouse(opened, served)

    next(mouse.drag("tcp", 2, 0.03))
    opened.wait_text("#reach", "to the handle")
    mouse.drop()
    opened.wait("document.querySelectorAll('#ways button').length > 0")
    ghost = served.studio.cell.description.link_poses(served.studio.reach.ways[0].positions)
    chosen = "document.querySelectorAll('#ways button[aria-pressed=true]').length === 1"
    forearm = 0.5 * (ghost["link4"].translation + ghost["link5"].translation)
    mouse.click_until(forearm, chosen)
    assert served.studio.chosen is not None

    next(mouse.drag("object", 0, 0.05))
    mouse.drop()
    opened.wait("!ace.edit('editor').getValue().includes('[0.2, -0.15, 0.03]')")
    moved = served.studio.cell.document.object_spec("box")
    assert moved["pose"]["xyz"] == pytest.approx([0.25, -0.15, 0.03], abs=5e-3)

    next(mouse.drag("size", 2, 0.05))
    mouse.drop()
    opened.wait("!ace.edit('editor').getValue().includes('[0.06, 0.06, 0.06]')")
    larger = served.studio.cell.document.object_spec("box")
    assert larger["box"]["size"] == pytest.approx([0.06, 0.06, 0.11], abs=5e-3)
    assert larger["pose"]["xyz"][2] == pytest.approx(0.5 * larger["box"]["size"][2], abs=2e-4)

    for _ in mouse.drag("tcp", 2, 0.1, 0.5):
        pass
    mouse.drop()
    opened.wait("document.querySelector('#reach').innerText.includes('the nearest p')")
    assert "refused" in opened.page.get_attribute("#reach", "class")
    assert opened.complaints == []
    context.close()


def wait_for_client(opened, served):
    for _ in range(1000):
        for client in served.server.get_clients().values():
            opened.page.wait_for_timeout(200)
            return client
        opened.page.wait_for_timeout(20)
    raise AssertionError("viser's page does not connect")


def test_the_pick_of_the_guide_becomes_a_scenario_with_the_same_digest(picked):
    opened, served = picked
    shown = opened.page.get_attribute(".outcome", "data-digest")
    assert served.files.path.read_text() == opened.editor()
    result = run_case(RunRequest(served.files.path))
    assert (result.outcome, result.digest) == ("passed", shown)
    assert [verdict.status for verdict in result.verdicts] == ["passed"] * len(result.verdicts)
    assert served.studio.cell.object_poses()["box"].translation[2] > 0.09


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


def test_the_field_of_a_step_is_completed(opened):
    opened.page.evaluate("document.querySelectorAll('details').forEach((e) => { e.open = true; })")

    def offered(text):
        opened.page.fill("#step-text", text)
        opened.wait(f"[...document.querySelectorAll('#continuations option')].some({starts(text)})")
        return opened.page.evaluate(OFFERED)

    assert {"pick: ", "place: ", "wait: "} <= set(offered(""))
    assert "place: {object: x, pose: " in offered("place: {object: x, ")
    assert "move_to: home" in offered("move_to: ")
    opened.page.fill("#step-text", "")


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


def test_every_control_is_reached_with_the_tab_key_and_has_a_name(opened):
    page = opened.page
    page.evaluate("document.querySelectorAll('details').forEach((each) => { each.open = true; })")
    assert page.evaluate(f"{VISIBLE}.filter((e) => !({NAMED})).map((e) => e.outerHTML)") == []
    page.evaluate("window.reached = new Set(); document.activeElement.blur()")
    for _ in range(page.evaluate(f"{VISIBLE}.length") + 10):
        page.keyboard.press("Tab")
        if page.evaluate(REACHED) == "TEXTAREA":
            page.keyboard.press("Escape")  # the Tab key indents the text
    assert page.evaluate(f"{VISIBLE}.filter((e) => !reached.has(e)).map((e) => e.outerHTML)") == []


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


def test_the_angles_of_a_goal_are_converted_with_their_unit(opened):
    opened.page.fill("#goal-pitch", "90")
    opened.page.select_option("#unit", "rad")
    assert opened.page.input_value("#goal-pitch") == "1.5708"
    opened.page.select_option("#unit", "deg")
    opened.page.fill("#goal-pitch", "0")


@pytest.mark.nightly
def test_a_second_page_watches_until_it_is_given_control(browser, opened, served):
    context = new_context(browser)
    second = Page(context, served.address)
    second.wait_text("#control-state", "you watch")
    good = opened.editor()
    opened.type_scenario(f"{good}# edited by the one that controls\n")
    second.wait("ace.edit('editor').getValue().includes('# edited')")
    opened.type_scenario(good)
    second.page.fill('input[aria-label="joint1 number"]', "0.2")
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
