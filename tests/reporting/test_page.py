"""A run's page in a real browser, opened from disk."""

import re
import shutil

import numpy as np
import pytest

from harness.recording.read_run import read_run
from tests.reporting.browser import put_back, visits, wait_for, wait_for_frame

PICTURE = """() => {
  const canvas = document.querySelector('#view canvas');
  const copy = document.createElement('canvas');
  [copy.width, copy.height] = [64, 48];
  const pen = copy.getContext('2d', {willReadFrequently: true});
  pen.drawImage(canvas, 0, 0, 64, 48);
  return [...pen.getImageData(0, 0, 64, 48).data];
}"""

COUNT_PLOTS = """addEventListener('beforeprint', () => {
  window.drawn = document.querySelectorAll('#paper-plots img').length;
})"""


def picture(page):
    wait_for_frame(page)
    return np.array(page.evaluate(PICTURE)).reshape(48, 64, 4)[:, :, :3].astype(int)


@pytest.fixture(scope="module")
def shared(browser, failed_run):
    with visits(browser) as visit:
        yield visit(failed_run / "report.html")


@pytest.fixture
def opened(shared):
    """The page that tests share, at its beginning and with nothing zoomed."""
    put_back(shared.page, "#t=0&tab=expect")
    return shared


@pytest.fixture(scope="module")
def shared_scene(browser, failed_run):
    with visits(browser) as visit:
        yield visit(failed_run / "report.html", has_scene=True)


@pytest.fixture
def drawn(shared_scene):
    """The page with its 3D view, which tests share, too."""
    put_back(shared_scene.page, "#t=0&tab=expect")
    yield shared_scene
    shared_scene.page.emulate_media(color_scheme="light")
    shared_scene.page.set_viewport_size({"width": 1100, "height": 720})


def test_the_page_reports_outcome_steps_and_expectations(opened):
    page = opened.page
    assert opened.text("header .pill") == "FAILED"
    assert page.locator("#steps .step").count() == 4
    assert page.locator("#steps .step.good").count() == 3, "a step with an expectation that fails"
    assert opened.text("#steps .step.bad b").startswith("swing")
    assert "duration" in opened.text("#steps .step.bad .why")
    assert opened.text("#tab-expect .badge") == "2/4"
    first = page.locator(".verdict").first
    assert "bad" in first.get_attribute("class"), "those that do not hold come first"
    assert first.locator(".margin").count() == 1


def test_text_of_the_user_is_text_and_never_markup(opened, failed_run):
    page = opened.page
    assert page.title().startswith("failed: <script>")
    assert page.locator("header h1").inner_text().startswith("<script>document.title")
    assert page.locator("#steps img").count() == 0
    page.click("#tab-source")
    assert "</script><script>" in opened.text(".source")
    text = (failed_run / "report.html").read_text()
    assert text.count("<script") == 3, "only the page's own"
    assert "<b>bold" not in text


def test_the_robot_is_drawn_and_moves_with_the_time(drawn):
    page = drawn.page
    start = picture(page)
    assert start.std() > 10, "an empty picture"
    page.click("#steps .step.bad")
    assert drawn.time() > 3
    assert np.abs(picture(page) - start).max() > 40


@pytest.mark.nightly
def test_a_page_that_shows_a_still_moment_requests_no_frames(drawn):
    page = drawn.page
    page.evaluate("""window.lastFrame = 0, window.requested = 0,
    window.requestAnimationFrame = ((request) => (task) => {
      window.lastFrame = performance.now();
      window.requested++;
      return request(task);
    })(window.requestAnimationFrame), null""")
    wait_for(page, "performance.now() - window.lastFrame > 1500")  # the film is drawn
    before = page.evaluate("window.requested")
    page.select_option("#speed", "10")
    page.click("#play")
    wait_for(page, f"window.requested > {before}")
    wait_for(page, "document.querySelector('#play').ariaLabel === 'Play'")  # at its end


def test_playing_moves_the_time_and_stops_at_the_end(opened):
    page = opened.page
    page.select_option("#speed", "10")
    page.keyboard.press("Escape")
    page.evaluate("""window.labels = [], new MutationObserver(() => {
      window.labels.push(document.querySelector('#play').ariaLabel);
    }).observe(document.querySelector('#play'), {attributes: true}), null""")
    page.click("#play")
    wait_for(page, "window.labels.includes('Pause') && window.labels.at(-1) === 'Play'")
    end = float(page.get_attribute("#track", "aria-valuemax"))
    assert opened.time() == pytest.approx(end, abs=1e-3)


def test_keys_seek_play_and_go_to_failures(opened):
    page = opened.page
    page.keyboard.press("Shift+ArrowRight")
    assert opened.time() == pytest.approx(1.0, abs=1e-3)
    page.keyboard.press("ArrowLeft")
    assert opened.time() == pytest.approx(0.98, abs=1e-3)
    page.keyboard.press("End")
    assert opened.time() == pytest.approx(float(page.get_attribute("#track", "aria-valuemax")))
    page.keyboard.press("Home")
    page.keyboard.press("n")
    assert "expect=" in page.url
    page.keyboard.press(" ")
    wait_for(page, "document.querySelector('#play').ariaLabel === 'Pause'")
    page.keyboard.press(" ")
    wait_for(page, "document.querySelector('#play').ariaLabel === 'Play'")


def test_dragging_over_the_timeline_scrubs(opened):
    page = opened.page
    box = page.locator("#track").bounding_box()
    middle = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + 1, middle)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] / 2, middle, steps=4)
    half = opened.time()
    page.mouse.move(box["x"] + box["width"] * 0.75, middle, steps=4)
    page.mouse.up()
    end = float(page.get_attribute("#track", "aria-valuemax"))
    assert half == pytest.approx(end / 2, rel=0.02)
    assert opened.time() == pytest.approx(0.75 * end, rel=0.02)


def test_a_verdict_seeks_to_the_sample_that_decided_it(opened, failed_run):
    stored = read_run(failed_run)
    number = next(i for i, v in enumerate(stored.verdicts) if v.expectation.startswith("clearance"))
    opened.page.click(f"[data-verdict='{number}']")
    assert opened.time() == pytest.approx(stored.verdicts[number].time, abs=2e-3)
    assert opened.page.url.endswith(f"expect={number + 1}")
    titles = opened.page.locator(".plot select").evaluate_all("all => all.map(s => s.value)")
    assert "clearance" in titles, "the plot of what was measured is shown"


def test_a_deep_link_opens_a_moment_and_an_expectation(visit, failed_run):
    opened = visit(failed_run / "report.html", "#t=1.5&expect=2")
    assert opened.time() == pytest.approx(1.5, abs=1e-3)
    assert opened.page.locator("[data-verdict='1'][aria-current]").count() == 1
    opened = visit(failed_run / "report.html", "#t=nonsense&expect=99&tab=source")
    assert opened.time() == 0
    assert opened.page.locator("#panel-source").is_visible()


def test_without_a_place_in_the_address_a_failure_is_shown(visit, failed_run):
    stored = read_run(failed_run)
    first = next(i for i, each in enumerate(stored.verdicts) if each.status != "passed")
    opened = visit(failed_run / "report.html")
    assert opened.page.locator(f"[data-verdict='{first}'][aria-current]").count() == 1
    assert opened.time() == pytest.approx(stored.verdicts[first].time, abs=2e-3)


LATE_FAILURE = """\
scenario: the fourth motion fails
robot: open_manipulator_x
steps:
  - lin: {position: {xyz: [0.2, 0, 0.2]}}
  - lin: {position: {xyz: [0.22, 0, 0.2]}}
  - lin: {position: {xyz: [0.2, 0, 0.2]}}
  - move_to: {position: {xyz: [0.2, 0.3, 0.9]}}
"""


@pytest.mark.nightly
def test_the_page_opens_at_what_was_planned_for_the_step_that_failed(recorded_run, visit):
    folder = recorded_run(LATE_FAILURE, "failed", page=True) / "run"
    page = visit(folder / "report.html", width=1440, height=600).page
    panel, part = (
        page.locator(name).bounding_box() for name in ("#panels", "#panel-planner [data-step='3']")
    )
    assert panel["y"] <= part["y"] + 1 < panel["y"] + 40, "below those of three steps that passed"
    assert "m/s" in page.inner_text("#panel-planner [data-step='2']"), "speeds have their unit"


def test_dragging_in_a_plot_zooms_all_of_them_and_a_click_seeks(opened):
    page = opened.page
    canvas = page.locator(".plot canvas").first
    box = canvas.bounding_box()
    y = box["y"] + box["height"] / 2
    before = canvas.screenshot(), page.locator(".plot canvas").nth(1).screenshot()
    page.mouse.move(box["x"] + 90, y)
    page.mouse.down()
    page.mouse.move(box["x"] + 190, y, steps=4)
    page.mouse.up()
    assert page.locator("#plots.zoomed").count() == 1
    page.mouse.move(box["x"] + 90, y)
    after = canvas.screenshot(), page.locator(".plot canvas").nth(1).screenshot()
    assert all(old != new for old, new in zip(before, after, strict=True))
    page.mouse.click(box["x"] + 120, y)
    assert opened.time() > 0
    assert page.locator("#unzoom").is_visible(), "the timeline shows the same stretch"
    page.click("#unzoom")
    assert page.locator("#plots.zoomed").count() == 0


def test_every_signal_can_be_plotted_with_its_value_at_the_cursor(opened):
    page = opened.page
    choice = page.locator(".plot select").first
    names = choice.locator("option").evaluate_all("all => all.map(o => o.value)")
    assert {"position", "velocity", "effort", "tracking", "gripper", "clearance"} <= set(names)
    page.keyboard.press("End")
    for name in names:
        choice.select_option(name)
        shown = page.locator(".plot output").first.inner_text()
        assert re.match(r"^-?\d", shown), (name, shown)


def test_keys_zoom_the_plots(opened):
    page = opened.page
    page.locator(".plot canvas").nth(1).focus()
    page.keyboard.press("+")
    assert page.locator("#plots.zoomed").count() == 1
    assert opened.time() == 0, "the key is the plot's"
    page.keyboard.press("0")
    assert page.locator("#plots.zoomed").count() == 0


@pytest.mark.nightly
def test_a_legend_hides_a_line_everywhere(opened):
    page = opened.page
    chips = page.locator(".legend button[title='elbow_joint']")
    assert chips.count() == 1, "one legend for all plots"
    before = [each.screenshot() for each in page.locator(".plot canvas").all()]
    chips.first.click()
    after = [each.screenshot() for each in page.locator(".plot canvas").all()]
    assert sum(old != new for old, new in zip(before, after, strict=True)) >= 2
    pressed = chips.evaluate_all("all => all.map(chip => chip.ariaPressed)")
    assert set(pressed) == {"false"}
    chips.first.click()
    assert chips.first.get_attribute("aria-pressed") == "true"


def test_tabs_show_planner_source_joints_and_environment(opened):
    page = opened.page
    page.click("#tab-planner")
    assert "state checks" in opened.text("#panel-planner")
    page.click("#steps .step >> nth=2")
    panel, part = (
        page.locator(name).bounding_box() for name in ("#panels", "#panel-planner [data-step='2']")
    )
    assert panel["y"] <= part["y"] + 1 < panel["y"] + panel["height"], "what was planned for it"
    page.locator("#tab-planner").focus()
    page.keyboard.press("ArrowRight")
    assert page.locator("#panel-findings").is_visible()
    contact = page.locator(".contacts tbody tr", has_text="Table and beer_0")
    contact.locator("button").click()
    assert opened.time() < 0.01
    assert contact.locator("td").last.inner_text().endswith(" N")
    page.click("#tab-source")
    failing = page.locator(".source .line.failing").all_inner_texts()
    assert any("duration" in line for line in failing)
    page.click("#tab-joints")
    assert "shoulder_pan_joint" in opened.text("#panel-joints")
    page.click("#tab-environment")
    assert "mujoco" in opened.text("#panel-environment")


@pytest.mark.nightly
def test_light_and_dark_differ_and_can_be_switched(visit, failed_run):
    shades = {}
    for scheme in ("light", "dark"):
        opened = visit(failed_run / "report.html", color_scheme=scheme, has_scene=True)
        shades[scheme] = picture(opened.page)[:4].mean()
        page_colour = "getComputedStyle(document.body).backgroundColor"
        first = opened.page.evaluate(page_colour)
        opened.page.click("#theme")
        assert opened.page.evaluate(page_colour) != first
    assert shades["light"] > 180 > 80 > shades["dark"]


def test_without_scripts_the_summary_is_there_to_read(visit, failed_run):
    opened = visit(failed_run / "report.html", scripts=False)
    assert not opened.page.locator("#app").is_visible()
    text = opened.text("#summary")
    for said in ("FAILED", "ptp", "duration", "failed by", "seed", "digest", "tracking error"):
        assert said in text
    assert "- duration: {at_most: 0.2}" in text, "the line of the file that does not hold"
    assert opened.page.locator("#summary .pictures img").count() >= 2


def test_a_telephone_sees_everything_without_scrolling_sideways(drawn):
    page = drawn.page
    page.set_viewport_size({"width": 390, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    for name in ("#view", "#track", "#steps", "#tabs", ".plot canvas"):
        assert page.locator(name).first.bounding_box()["width"] > 200, name
    assert picture(page).std() > 10


def test_it_prints_on_one_or_two_pages(drawn):
    page = drawn.page
    page.emulate_media(color_scheme="dark")
    page.evaluate(COUNT_PLOTS)
    pdf = page.pdf(prefer_css_page_size=True)
    pages = len(re.findall(rb"/Type\s*/Page\b(?!s)", pdf))
    assert 1 <= pages <= 2
    assert page.evaluate("window.drawn") == 4, "plots on paper"
    assert page.evaluate("document.documentElement.dataset.theme") is None, "dark again"


@pytest.mark.nightly
def test_a_browser_without_webgl_still_shows_the_rest(failed_run, visit):
    opened = visit(failed_run / "report.html", has_scene=False)
    page = opened.page
    assert page.locator(".no-view").is_visible()
    page.click(".verdict >> nth=0")
    assert opened.time() > 0


def test_a_saved_run_gets_the_same_page_again(failed_run, tmp_path, capsys):
    from harness.cli.main import main

    folder = tmp_path / "copy"
    shutil.copytree(failed_run, folder)
    (folder / "report.html").unlink()
    assert main(["view", f"{folder}#t=1", "--no-open"]) == 0
    assert capsys.readouterr().out == f"{folder}/report.html#t=1\n"
    written = (failed_run / "report.html").read_text()
    assert (folder / "report.html").read_text() == written
    assert main(["view", str(tmp_path), "--no-open"]) == 2


CONTRASTS = """() => {
  const pen = document.createElement('canvas').getContext('2d', {willReadFrequently: true});
  const rgba = (colour) => {
    pen.clearRect(0, 0, 1, 1);
    pen.fillStyle = colour;
    pen.fillRect(0, 0, 1, 1);
    const [r, g, b, a] = pen.getImageData(0, 0, 1, 1).data;
    return [r, g, b, a / 255];
  };
  const over = ([r, g, b, a], under) => [r, g, b].map((v, i) => a * v + (1 - a) * under[i]);
  const light = (rgb) => rgb.map((v) => v / 255)
    .map((v) => (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
    .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const found = [];
  for (const element of document.querySelectorAll('#app *')) {
    const own = [...element.childNodes].some((n) => n.nodeType === 3 && n.textContent.trim());
    if (!own || !element.checkVisibility() || element.closest('canvas, option')) continue;
    const chain = [];
    for (let each = element; each; each = each.parentElement) chain.unshift(each);
    let [back, solid] = [[255, 255, 255], 1];
    for (const each of chain) {
      back = over(rgba(getComputedStyle(each).backgroundColor), back);
      solid *= Number(getComputedStyle(each).opacity);
    }
    const colour = rgba(getComputedStyle(element).color);
    const front = over([...colour.slice(0, 3), colour[3] * solid], back);
    const [a, b] = [light(front), light(back)].sort((x, y) => y - x);
    found.push([(a + 0.05) / (b + 0.05), `${element.tagName}.${element.className}`]);
  }
  return found;
}"""


@pytest.mark.nightly(but=["dark"])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_stands_out_from_its_background(drawn, scheme):
    """Contrast of 4.5, as WCAG 2.1 requires (1.4.3); what is switched off may have less."""
    page = drawn.page
    page.emulate_media(color_scheme=scheme)
    for tab in ("expect", "planner", "findings", "source", "joints", "environment"):
        page.click(f"#tab-{tab}")
        found = page.evaluate(CONTRASTS)
        assert len(found) > 50
        weak = {name for contrast, name in found if contrast < 4.5}
        assert not weak, (tab, weak)


def test_everything_that_can_be_used_has_a_name_and_can_be_reached_by_keys(drawn):
    page = drawn.page
    kinds = ("button", "select", "canvas", "[role=slider]", "[role=img]")
    used = page.locator(", ".join(f"#app {kind}" for kind in kinds))
    nameless = used.evaluate_all(
        """all => all.filter(e => !e.closest('[aria-hidden=true]') && !e.ariaLabel && !e.title
             && !e.innerText?.trim() && !(e.closest('.camera'))).map(e => e.outerHTML)"""
    )
    assert nameless == []
    page.evaluate("document.activeElement.blur()")
    reached = set()
    for _ in range(120):
        page.keyboard.press("Tab")
        reached.add(
            page.evaluate(
                "(document.activeElement.closest('#steps, #view, #timeline, #tabs, #panels,"
                " #plots, .buttons') ?? document.activeElement).id || 'buttons'"
            )
        )
    assert {"steps", "view", "timeline", "tabs", "panels", "plots", "buttons"} <= reached


@pytest.mark.nightly(but=["390"])
@pytest.mark.parametrize("width", [1280, 390])
def test_every_tab_and_every_label_of_the_timeline_is_shown_whole_enough(visit, failed_run, width):
    """No tab is beyond the edge, and a band that is too narrow for its label has none."""
    page = visit(failed_run / "report.html", width=width).page
    assert page.evaluate("scrollY") == 0  # opened at its failure, whose verdict is farther down
    assert page.evaluate(
        "(list => list.scrollWidth <= list.clientWidth)(document.querySelector('#tabs'))"
    )
    widths = page.evaluate(
        "[...document.querySelectorAll('.band span')]"
        ".filter(label => label.getClientRects().length)"
        ".map(label => label.parentElement.clientWidth)"
    )
    assert all(each > 40 for each in widths)


@pytest.mark.nightly
def test_a_failed_run_opens_near_what_failed_and_iso_shows_all_of_it(browser, failed_run):
    with visits(browser) as visit:
        page = visit(failed_run / "report.html", width=1100, height=720, has_scene=True).page
        near = picture(page)
        page.click("#sides button:text('iso')")
        whole = picture(page)
        assert np.abs(near - whole).mean() > 2
        page.click("#sides button:text('iso')")
        assert np.abs(picture(page) - whole).mean() < 1


def test_a_failed_step_takes_two_lines_of_its_reason_until_it_is_chosen(opened):
    reason = opened.page.locator("#steps .step.bad .why").first
    style = "(each) => getComputedStyle(each).webkitLineClamp"
    assert reason.evaluate(style) == "2"
    opened.page.click("#steps .step.bad")
    assert reason.evaluate(style) == "none"


def test_a_verdict_has_its_margin_and_its_place_in_one_line(opened):
    below = opened.page.locator(".verdict.good .below").first
    assert re.fullmatch(r".*margin .*\n?t = [\d.]+ s · line \d+", below.inner_text())
    assert below.bounding_box()["height"] < 25
