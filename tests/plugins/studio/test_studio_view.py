"""The picture of the studio: objects and handles under the real mouse, ghosts, plans and plots."""

import numpy as np
import pytest

from harness.plugins.studio.document import new_text
from tests.plugins.studio.test_studio_page import Page
from tests.reporting.browser import new_context
from tests.waiting import wait_for as wait

pytest.importorskip("django_static_ace_builds")

SCENE = "const { scene } = await import('/studio/scene.js');"
PLACE = f"""async (point) => {{
  {SCENE}
  const box = scene.viewer.canvas.getBoundingClientRect();
  const [x, y] = scene.viewer.project(scene.orbit, point);
  return [box.x + x, box.y + y];
}}"""
SELECTED = f"(async () => {{ {SCENE} return scene.selected; }})()"
COPIES = f"""(async () => {{
  {SCENE}
  return scene.viewer.surfaces.filter((each) => each.recedes && each.visible).length;
}})()"""
PIXELS = f"""async (points) => {{
  {SCENE}
  const {{ canvas, gl }} = scene.viewer;
  return points.map(([x, y]) => {{
    const pixel = new Uint8Array(4);
    gl.readPixels(x * canvas.width, y * canvas.height, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    return [...pixel].slice(0, 3);
  }});
}}"""
DRAWN = (
    f"(async () => {{ {SCENE} return Boolean(scene.viewer?.drawn) && !scene.viewer.isDirty; }})()"
)


class View:
    """A page with a picture, and its studio, whose physics stands still."""

    def __init__(self, browser, served, **options):
        self.context = new_context(browser, viewport={"width": 1010, "height": 520}, **options)
        self.opened = Page(self.context, served.address, has_scene=True)
        self.page, self.mouse, self.served = self.opened.page, self.opened.page.mouse, served
        self.page.select_option("#speed", "0")
        wait(lambda: self.page.evaluate(DRAWN))
        served.studio.session.at_once["play"]({"on": False})

    def at(self, point):
        return self.page.evaluate(PLACE, list(point))

    def drag(self, start, end):
        self.mouse.move(*start)
        self.mouse.down()
        self.mouse.move(*[0.5 * (a + b) for a, b in zip(start, end, strict=True)])
        self.mouse.move(*end)
        self.mouse.up()

    def middle_of(self, label, share=0.5):
        hit = self.page.locator(f"#gizmo g[aria-label='{label}'] .hit")

        def settled():
            """Its place, once the picture is drawn and it stays there."""
            before = hit.bounding_box()
            self.page.wait_for_timeout(200)
            is_drawn = self.page.evaluate(DRAWN) and before and before["width"] > 0
            return before if is_drawn and before == hit.bounding_box() else None

        box = wait(settled)
        return box["x"] + 0.5 * box["width"], box["y"] + share * box["height"]

    def spec(self):
        return self.served.studio.cell.document.object_spec("box")

    def close(self):
        assert self.opened.complaints == []
        self.context.close()


@pytest.fixture(scope="module")
def view(browser, serve):
    served = serve(new_text("by hand", {"model": "open_manipulator_x"}, "empty"))
    size, xyz = [0.06, 0.06, 0.06], [0.2, -0.15, 0.03]
    assert served.reply_to("add_object", name="box", kind="box", size=size, xyz=xyz) == {}
    view = View(browser, served)
    yield view
    view.close()


@pytest.mark.nightly
def test_an_object_is_selected_with_a_click_and_dragged(view):
    start, end = view.at([0.2, -0.15, 0.03]), view.at([0.26, -0.12, 0.03])
    view.mouse.click(*start)
    wait(lambda: view.page.evaluate(SELECTED) == "box")
    view.drag(start, end)
    wait(lambda: view.spec()["pose"]["xyz"] != [0.2, -0.15, 0.03])
    assert view.spec()["pose"]["xyz"] == pytest.approx([0.26, -0.12, 0.03], abs=8e-3)
    wait(lambda: "xyz: [0.2, -0.15" not in view.opened.editor())
    assert view.page.evaluate(SELECTED) == "box", "it stays selected, and its handles on it"
    wait(lambda: np.hypot(*np.subtract(view.middle_of("move x"), end)) < 100)
    view.page.keyboard.press("Escape")
    wait(lambda: view.page.evaluate(SELECTED) == "")


@pytest.mark.nightly
def test_handles_move_turn_and_size_an_object_and_move_the_goal(view):
    view.page.click("#show-objects")
    view.page.click(".object:has-text('box')")
    before = view.spec()["pose"]["xyz"]
    x, y = view.middle_of("move z", 0.3)
    view.drag((x, y), (x, y - 30))
    wait(lambda: view.spec()["pose"]["xyz"][2] > before[2] + 0.01)
    assert view.spec()["pose"]["xyz"][:2] == pytest.approx(before[:2], abs=1e-3)
    x, y = view.middle_of("turn z", 0.98)
    view.drag((x, y), (x + 30, y - 4))
    wait(lambda: "rpy" in view.spec()["pose"])
    assert view.spec()["pose"]["rpy"][:2] == [0, 0]
    height = view.spec()["box"]["size"][2]
    x, y = view.middle_of("size z")
    view.drag((x, y), (x, y - 20))
    wait(lambda: view.spec()["box"]["size"][2] > height + 0.005)
    assert view.spec()["box"]["size"][:2] == [0.06, 0.06]
    view.page.keyboard.press("Escape")
    view.page.click("#show-arm")
    tcp = view.served.studio.cell.tcp_pose().translation
    x, y = view.middle_of("move z", 0.3)
    view.drag((x, y), (x, y - 20))
    view.opened.wait_text("#reach", "to the handle")
    goal = view.served.studio._goal.translation  # noqa: SLF001 - where the handle was left
    assert goal[2] > tcp[2] + 0.01
    assert goal[:2] == pytest.approx(tcp[:2], abs=1e-3)


@pytest.mark.nightly
def test_a_plan_is_a_ghost_on_a_slider_and_no_ghost_lies_on_the_robot(view):
    studio = view.served.studio
    view.served.reply_to("goal", here=True)
    view.opened.wait_text("#reach", "1 way to the handle")
    wait(lambda: view.page.evaluate(COPIES) == 0)
    view.served.reply_to("goal", xyz=[0.2, 0, 0.15], rpy=[0, 60, 0], unit="deg")
    wait(lambda: view.page.evaluate(COPIES) > 0)
    assert view.page.is_hidden("#plan-bar")
    view.page.click("#plan")
    view.opened.wait_text("#plan-result", "takes")
    view.opened.wait("!document.getElementById('plan-bar').hidden")
    share = "bar => {{ bar.value = {}; bar.dispatchEvent(new Event('input')); }}"
    view.page.eval_on_selector("#plan-time", share.format(0))
    wait(lambda: view.page.evaluate(COPIES) == 0)
    assert view.page.inner_text("#plan-clock").startswith("0.00 / ")
    view.page.eval_on_selector("#plan-time", share.format(0.7))
    wait(lambda: view.page.evaluate(COPIES) > 0)
    view.page.click("#plan-play")
    view.opened.wait("document.getElementById('plan-time').value === '1'")
    view.page.click("#plan-close")
    view.opened.wait("document.getElementById('plan-bar').hidden")
    assert studio.cell.steps_done == 0, "nothing has moved"


@pytest.mark.nightly
def test_a_way_is_shown_alone_while_its_button_is_under_the_mouse(browser, serve):
    served = serve(new_text("by hand", {"model": "ur3e"}, "empty"))
    view = View(browser, served)
    goal = {"xyz": [0.25, 0.1, 0.3], "rpy": [180, 0, 90], "unit": "deg"}
    assert served.reply_to("goal", **goal)["ways"] > 3
    view.opened.wait("document.querySelectorAll('.way').length > 3")
    names = view.page.evaluate("[...document.querySelectorAll('.way')].map((e) => e.innerText)")
    assert len(set(names)) == len(names)
    wait(lambda: view.page.evaluate(COPIES) > 0)
    all_ways = view.page.evaluate(COPIES)
    view.page.hover(".way:nth-child(3)")
    wait(lambda: 0 < view.page.evaluate(COPIES) < all_ways)
    view.page.hover("#plan")
    wait(lambda: view.page.evaluate(COPIES) == all_ways)
    view.close()


@pytest.mark.nightly
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_there_is_a_sky_above_a_floor(browser, serve, scheme):
    view = View(browser, serve(), color_scheme=scheme)
    view.page.click("#sides button:has-text('side')")
    wait(lambda: view.page.evaluate(DRAWN))
    high, low, floor = np.array(
        view.page.evaluate(PIXELS, [[0.03, 0.98], [0.03, 0.55], [0.03, 0.02]])
    )
    assert np.abs(high - low).sum() > 8, "the sky has another colour above than at the horizon"
    assert np.abs(low - floor).sum() > 8
    assert (high.mean() > 128) == (scheme == "light")
    view.close()


LATEST = "(async () => (await import('/studio/plots.js')).latest())()"


@pytest.mark.nightly
def test_plots_go_on_while_the_arm_moves(view):
    view.served.studio.session.at_once["play"]({"on": True})
    view.page.evaluate("document.getElementById('plots').classList.remove('folded')")
    view.page.fill('input[aria-label="joint1 number"]', "20")
    view.page.press('input[aria-label="joint1 number"]', "Enter")
    wait(lambda: abs((view.page.evaluate(LATEST) or {"joint1": 0})["joint1"] - 20) < 0.5)
    view.page.select_option("#plot-kind", "TCP speed")
    wait(lambda: "TCP" in (view.page.evaluate(LATEST) or {}))
    view.served.studio.session.at_once["play"]({"on": False})
