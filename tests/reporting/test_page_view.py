"""The 3D view, the steps and the timeline of a run's page, in a real browser."""

import numpy as np
import pytest

from harness.recording.read_run import read_run
from tests.reporting.browser import put_back, visits, wait_for, wait_for_frame
from tests.reporting.test_page import picture

NESTED = """\
scenario: nested steps
robot: {model: open_manipulator_x}
steps:
  - repeat:
      times: 2
      steps:
        - ptp: {joints: {joint1: 0.2}}
        - ptp: {joints: {joint1: 0.0}}
    id: nod
  - wait: 0.2
    id: rest
    expect:
      - clearance: {at_least: 0.001}
"""


@pytest.fixture(scope="module")
def nested_run(recorded_run):
    return recorded_run(NESTED, page=True) / "run"


@pytest.fixture(scope="module")
def shared(browser, nested_run):
    with visits(browser) as visit:
        yield visit(nested_run / "report.html", width=1440, height=900, has_scene=True)


@pytest.fixture
def page(shared):
    put_back(shared.page, "#t=0.5")
    shared.page.click("#sides button:text('iso')")
    return shared.page


FILLED = """() => {
  const view = document.querySelector('#view canvas');
  const copy = document.createElement('canvas');
  [copy.width, copy.height] = [view.width, view.height];
  const pen = copy.getContext('2d');
  pen.drawImage(view, 0, 0);
  const {data} = pen.getImageData(0, 0, copy.width, copy.height);
  let [top, bottom] = [copy.height, 0];
  for (let i = 0; i < data.length; i += 4) {
    if (Math.max(data[i], data[i + 1], data[i + 2]) > 110) continue; // only the arm is dark
    const row = Math.floor(i / 4 / copy.width);
    [top, bottom] = [Math.min(top, row), Math.max(bottom, row)];
  }
  return (bottom - top) / copy.height;
}"""


def test_the_first_view_is_filled_by_the_arm(page):
    wait_for_frame(page)
    assert page.evaluate(FILLED) > 0.5


@pytest.mark.nightly
def test_sides_show_the_arm_from_elsewhere(page):
    seen = []
    for side in ("iso", "front", "side", "top", "follow TCP"):
        page.click(f"#sides button:text-is('{side}')")
        seen.append(picture(page))
    for number, one in enumerate(seen):
        assert all(np.abs(one - other).mean() > 2 for other in seen[:number]), number


@pytest.mark.nightly
def test_the_wheel_zooms_to_what_is_under_the_pointer(page):
    """What is under the pointer stays there; zooming to the middle would move it away."""
    box = page.locator("#view canvas").bounding_box()
    x, y = box["width"] * 0.3, box["height"] * 0.6
    near = {"x": box["x"] + x - 4, "y": box["y"] + y - 4, "width": 8, "height": 8}
    page.mouse.move(box["x"] + x, box["y"] + y)
    before = page.screenshot(clip=near)
    page.mouse.wheel(0, -600)
    wait_for_frame(page)
    assert page.screenshot(clip=near) is not None
    first = picture(page)
    page.mouse.wheel(0, 600)
    wait_for_frame(page)
    assert page.screenshot(clip=near) == before, "back again"
    page.mouse.move(box["x"] + box["width"] * 0.7, box["y"] + y)
    page.mouse.wheel(0, -600)
    assert np.abs(picture(page) - first).mean() > 2, "another place is nearer now"


@pytest.mark.nightly
def test_a_click_on_a_body_shows_what_it_is(page, nested_run):
    robot = read_run(nested_run).run.robot
    page.click("#sides button:text-is('follow TCP')")
    wait_for_frame(page)
    box = page.locator("#view canvas").bounding_box()
    card = page.locator(".card")
    found = set()
    for share in np.linspace(0.3, 0.6, 7):
        page.mouse.click(box["x"] + share * box["width"], box["y"] + box["height"] / 2)
        if card.is_visible():
            found.add(card.locator("h3").inner_text().split()[0])
            assert "mm" in card.inner_text()
            assert "°" in card.inner_text()
            card.locator("button[aria-label=Close]").click()
    page.click("#sides button:text-is('follow TCP')")
    assert found & set(robot.link_names)


@pytest.mark.nightly
def test_a_clearance_is_drawn_with_its_number(page):
    page.click(".verdict >> nth=0")
    label = page.locator(".labels output")
    assert label.count() == 1
    assert label.inner_text().endswith("mm")
    view, place = page.locator("#view").bounding_box(), label.bounding_box()
    page.mouse.move(view["x"] + 5, view["y"] + 5)
    for _ in range(6):
        page.mouse.wheel(0, -400)
    wait_for_frame(page)
    place = label.bounding_box()
    assert view["x"] <= place["x"]
    assert place["x"] + place["width"] <= view["x"] + view["width"]


@pytest.mark.nightly
def test_collision_shapes_and_the_commanded_robot_can_be_shown(page):
    page.click("#tools summary")
    before = picture(page)
    for tool in ("collisions", "commanded"):
        page.click(f"#tool-{tool}")
        assert page.get_attribute(f"#tool-{tool}", "aria-pressed") == "true"
        shown = picture(page)
        page.click(f"#tool-{tool}")
        assert np.abs(picture(page) - before).max() == 0
        if tool == "collisions":
            assert np.abs(shown - before).max() > 20
    page.click("#tools summary")


@pytest.mark.nightly
def test_steps_that_passed_are_folded_and_open_on_a_click(page):
    shown = page.locator("#steps li:visible")
    assert shown.count() == 2
    assert page.locator("#steps [aria-current]").inner_text().startswith("nod"), "marked around it"
    page.click(".fold >> nth=0")
    opened = shown.count()
    assert opened > 4
    assert page.locator("#steps [aria-current]").count() == 1
    page.click(".fold >> nth=0")
    assert shown.count() == 2
    title, line = (
        page.locator(f".step:has-text('rest') {part}").bounding_box()
        for part in (".title", ".place")
    )
    assert abs(title["y"] - line["y"]) < title["height"], "on one line"
    page.click(".dot >> nth=0")
    assert "expect=1" in page.url


def test_the_timeline_zooms_and_moves_by_wheel_and_keys(page):
    track = page.locator("#track")
    box = track.bounding_box()
    view = page.locator("#view").bounding_box()
    assert box["width"] > 0.95 * view["width"]
    widths = "[...document.querySelectorAll('.band')].map(each => each.offsetWidth)"
    whole = page.evaluate(widths)
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 5)
    page.mouse.wheel(0, -300)
    assert max(page.evaluate(widths)) > 1.5 * max(whole)
    assert page.locator("#plots.zoomed").count() == 1
    places = "[...document.querySelectorAll('.band')].map(each => each.offsetLeft)"
    before = page.evaluate(places)
    track.press(">")
    assert page.evaluate(places)[0] < before[0]
    track.press("0")
    assert page.evaluate(widths) == whole
    track.press("+")
    assert max(page.evaluate(widths)) > max(whole)
    page.click("#unzoom")
    assert page.evaluate(widths) == whole


def test_the_address_follows_the_clock(page):
    page.keyboard.press("Shift+ArrowRight")
    wait_for(page, "location.hash.includes('t=1.50')")
    page.click("#steps .step:has-text('rest')")
    assert "step=" in page.url
    page.keyboard.press("ArrowLeft")
    time = float(page.get_attribute("#track", "aria-valuenow"))
    wait_for(page, f"location.hash.startsWith('#t={time:.2f}')")
    assert "step=" in page.url, "the selection stays"


@pytest.mark.nightly
def test_the_view_comes_back_when_the_graphics_card_lost_it(page):
    wait_for_frame(page)
    before = picture(page)
    page.evaluate("""() => {
      const canvas = document.querySelector('#view canvas');
      window.loss = canvas.getContext('webgl2').getExtension('WEBGL_lose_context');
      canvas.addEventListener('webglcontextlost', () => (window.state = 'lost'));
      canvas.addEventListener('webglcontextrestored', () => (window.state = 'restored'));
      window.loss.loseContext();
    }""")
    wait_for(page, "window.state === 'lost'")
    page.evaluate("window.loss.restoreContext()")
    wait_for(page, "window.state === 'restored'")
    assert np.abs(picture(page) - before).max() <= 2, "the same picture as before"
    put_back(page, "#t=1.2")
    assert np.abs(picture(page) - before).max() > 20, "and it goes on"


@pytest.mark.nightly
def test_plots_and_pictures_are_saved_as_files(page, tmp_path):
    for selector, head in (
        (".plot button:text-is('SVG') >> nth=0", b"<svg"),
        (".plot button:text-is('PNG') >> nth=0", b"\x89PNG"),
        ("#sides button:text-is('PNG')", b"\x89PNG"),
    ):
        with page.expect_download() as saved:
            page.click(selector)
        file = tmp_path / "saved"
        saved.value.save_as(file)
        assert file.read_bytes().startswith(head)
        if head == b"<svg":
            text = file.read_text()
            assert text.count("<path") > 4
            assert "t [s]" in text


@pytest.mark.nightly
def test_values_are_shown_under_the_pointer(page):
    canvas = page.locator(".plot canvas").first
    page.mouse.move(2, 2)
    before = canvas.screenshot()
    box = canvas.bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    wait_for_frame(page)
    assert canvas.screenshot() != before
    page.mouse.move(2, 2)
    assert canvas.screenshot() == before
