"""Camera pictures, a ten-minute run and explained failures, in a real browser."""

from contextlib import closing
from dataclasses import replace

import cv2
import numpy as np
import pytest

from harness.core.camera import Camera
from harness.core.geometry import Box, Shape
from harness.recording.drawings import NO_DRAWINGS, Drawings
from harness.recording.film import encoded_film
from harness.recording.signals import CaptureRecord, ContactRecord, VideoRecord
from harness.recording.stored_run import StoredRun
from harness.recording.verdict import Verdict
from harness.reporting.html.write import Page
from harness.reporting.terminal import failure_place
from tests.judging.synthetic_run import (
    BOX,
    TABLE,
    changed,
    force,
    lift_run,
    make_run,
    step,
)
from tests.reporting.browser import (
    SOFTWARE_GL,
    WITHOUT_GRAPHICS_CARD,
    go_to,
    installed,
    visits,
    wait_for,
    wait_for_frame,
)
from tests.running import run_case

RED, GREEN = (0, 0, 255), (0, 255, 0)  # BGR

SHOWN = """(index) => {
  const canvas = document.querySelectorAll('.camera canvas')[index];
  return [...canvas.getContext('2d').getImageData(5, 5, 1, 1).data].slice(0, 3);
}"""

UNREACHABLE = """\
scenario: Too far
robot: {model: ur3e, base: {xyz: [0, 0, 1.02]}}
world: lesson_ur
steps:
  - ptp: {joints: {shoulder_pan_joint: 0.1}}
  - move_to: {pose: {frame: base_link, xyz: [0.9, 0, 0.3], quat_wxyz: [1, 0, 0, 0]}}
"""


def flat(colour):
    is_coded, data = cv2.imencode(".png", np.full((48, 64, 3), colour, np.uint8))
    assert is_coded
    return data.tobytes()


def video(frames=20, rate=10.0):
    """Red for its first half, then green."""
    colours = [RED if number < frames / 2 else GREEN for number in range(frames)]
    pictures = [np.full((48, 64, 3), colour[::-1], np.uint8) for colour in colours]
    return encoded_film(pictures, rate, (64, 48))


def write(folder, run, drawings=NO_DRAWINGS):
    file = folder / "report.html"
    stored = StoredRun(run, (), "passed", "0" * 64, {}, drawings=drawings)
    file.write_text(Page(run, ()).html(stored), encoding="utf-8")
    return file


def page_with_cameras(folder):
    """A page with a video, camera 0, and pictures, camera 1: both are red first, and then green."""
    captures = (
        CaptureRecord("wrist", 0.5, 50, "look", files={"color": "a.png"}),
        CaptureRecord("wrist", 1.5, 150, "look again", files={"color": "b.png"}),
    )
    times = tuple(0.1 * number for number in range(20))
    run = replace(
        lift_run(),
        cameras=(Camera("wrist", "palm"), Camera("room", "world")),
        captures=captures,
        files={"a.png": flat(RED), "b.png": flat(GREEN)},
    )
    videos = (VideoRecord("room", "c.mp4", times, 10.0, 64, 48, "rays"),)
    drawings = Drawings(videos=videos, files={"c.mp4": video()})
    return write(folder, run, drawings)


def wait_for_colour(page, colour):
    for number in (0, 1):
        shown = f"({SHOWN})({number})"
        wait_for(page, f"{shown}[{colour}] > 180 && {shown}[{1 - colour}] < 90")


def test_pictures_and_videos_follow_the_clock(visit, tmp_path):
    page = visit(page_with_cameras(tmp_path), has_scene=True).page
    captions = page.locator(".camera figcaption")
    assert captions.count() == 2
    for moment, colour, label in ((0.7, 0, "wrist · look"), (1.7, 1, "wrist · look again")):
        go_to(page, f"#t={moment}")
        wait_for_colour(page, colour)
        assert captions.nth(1).inner_text() == label
    page.keyboard.press("Home")
    assert captions.nth(1).inner_text() == "wrist · not before 0.50 s"
    assert page.locator("canvas.not-yet").count() == 1, "only dimly, before it is taken"
    width = page.locator(".camera").first.bounding_box()["width"]
    page.locator(".camera button").first.press("Enter")
    assert page.locator(".camera").first.bounding_box()["width"] > 1.5 * width, "enlarged"
    view = page.locator("#view").bounding_box()
    for camera in page.locator(".camera").all():
        box = camera.bounding_box()
        assert box["y"] >= view["y"] + view["height"], "no picture hides the replay"
    page.click("#tools summary")
    page.click("#tool-cameras")
    assert not page.locator(".camera").first.is_visible()
    assert page.locator("#view").bounding_box()["height"] > view["height"]


EMPTY = """() => [...document.querySelectorAll('.plot canvas')].map((canvas) => {
  const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  return data.every((value) => value === 0);
})"""


@pytest.mark.nightly
def test_pictures_and_plots_come_back_when_the_graphics_process_ended(browser, tmp_path):
    """In a browser of its own, which keeps pages from a view after that."""
    options = [*SOFTWARE_GL, *WITHOUT_GRAPHICS_CARD]
    with (
        closing(browser.browser_type.launch(executable_path=installed(), args=options)) as own,
        visits(own) as visit,
    ):
        page = visit(page_with_cameras(tmp_path), "#t=0.7").page
        wait_for_colour(page, 0)
        page.evaluate("""window.restored = 0, document.addEventListener(
          'contextrestored', () => window.restored++, true), null""")
        own.new_browser_cdp_session().send("Browser.crashGpuProcess")
        wait_for(page, "window.restored >= 2")
        wait_for_colour(page, 0)
        assert not any(page.evaluate(EMPTY))


def test_what_a_recording_does_not_show_is_grey_and_said_in_words(visit, tmp_path):
    run, why = lift_run(), "no topic has the pose of box"
    verdicts = (
        Verdict("box is lifted", "not observable", step="lift", reason=why),
        Verdict("clearance", "not reached", reason="step lift was not reached"),
        Verdict("duration", "passed", 0.1, "s", 0.5),
    )
    file = tmp_path / "report.html"
    stored = StoredRun(run, verdicts, "passed", "0" * 64, {}, drawings=NO_DRAWINGS)
    file.write_text(Page(run, ()).html(stored), encoding="utf-8")
    page = visit(file).page
    assert page.locator(":is(.verdict, .step, .dot, .mark, .line, #summary tr).bad").count() == 0
    assert page.locator(".verdict.open .what").all_inner_texts() == [
        "not observable",
        "not reached",
    ]
    assert why in page.inner_text(".verdict.open >> nth=0")
    assert page.locator("#steps .dot.open").count() == 1


@pytest.mark.nightly
def test_lines_of_one_plot_differ_when_there_are_more_than_colours(visit, tmp_path):
    pairs = [("left_finger", f"thing{number}") for number in range(30)]
    forces = {pair: np.full(200, 1.0 + number) for number, pair in enumerate(pairs)}
    page = visit(write(tmp_path, lift_run(contact_forces=forces, presses={}, frictions={}))).page
    for place, group in enumerate(("contact", "tcp", "gripper")):
        page.locator(".plot select").nth(place).select_option(group)
    names = "chips => chips.map((chip) => chip.querySelector('i').style.background)"
    swatches = page.locator(".legend button").evaluate_all(names)
    assert len(set(swatches)) == len(swatches) > 12


@pytest.mark.nightly
def test_a_ten_minute_run_opens_and_scrubs(visit, tmp_path):
    count = 60_001
    phase = np.linspace(0, 300, count)
    run = lift_run(count, joint_positions=np.stack([np.sin(phase), np.cos(phase)], axis=1))
    opened = visit(write(tmp_path, run))
    page = opened.page
    box = page.locator("#track").bounding_box()
    for share in (0.2, 0.5, 0.9):
        page.mouse.click(box["x"] + share * box["width"], box["y"] + 5)
        assert opened.time() == pytest.approx(600 * share, abs=3)
    shown = float(page.locator(".plot output").first.inner_text())
    expected = np.rad2deg(np.sin(300 * opened.time() / 600))
    assert shown == pytest.approx(expected, abs=0.2)


def test_contacts_are_reported_and_drawn_where_they_were(visit, tmp_path):
    pressed = np.full((200, 6), np.nan)
    pressed[50:150] = (0.3, 0.0, 0.1, 0.0, -12.5, 0.0)
    run = lift_run(presses={("left_finger", "box"): pressed})
    opened = visit(write(tmp_path, run), "#t=1", has_scene=True)
    page = opened.page
    reported = "left_finger presses box 12.5 N"
    assert reported in opened.text("#readout")
    wait_for_frame(page)
    with_arrow = page.locator("#view canvas").screenshot()
    page.click("#tools summary")
    page.click("#tool-contacts")
    wait_for_frame(page)
    assert reported not in opened.text("#readout")
    assert page.locator("#view canvas").screenshot() != with_arrow
    page.click("#tool-contacts")
    page.keyboard.press("Home")
    assert reported not in opened.text("#readout"), "before it touches"


HUES = """() => {
  const seen = document.createElement('canvas');
  const view = document.querySelector('#view canvas');
  [seen.width, seen.height] = [view.width, view.height];
  const pen = seen.getContext('2d');
  pen.drawImage(view, 0, 0);
  const data = pen.getImageData(0, 0, seen.width, seen.height).data;
  const found = {blue: 0, other: 0};
  for (let i = 0; i < data.length; i += 4) {
    const [r, g, b] = data.slice(i, i + 3);
    if (Math.max(r, g, b) - Math.min(r, g, b) < 40) continue;
    found[b > 1.6 * r && b > 1.6 * g ? 'blue' : 'other'] += 1;
  }
  return found;
}"""


def blue_cube(**changes):
    """A box that lies on a grey table under a hand; of the robot nothing is seen."""
    cube = replace(BOX, shapes=(Shape(Box((0.2, 0.2, 0.2)), rgba=(0.0, 0.0, 1.0, 1.0)),))
    table = replace(TABLE, shapes=(replace(TABLE.shapes[0], rgba=(0.5, 0.5, 0.5, 1.0)),))
    touching = {("Table", "box"): force(200, (0, 200), value=20.0)}
    return make_run(objects=(table, cube), contact_forces=touching, **changes)


@pytest.mark.nightly(but=["True-left_finger"])
@pytest.mark.parametrize("other", ["Table", "left_finger"])
@pytest.mark.parametrize("is_collision", [False, True])
def test_only_bodies_that_collide_change_their_colour(other, is_collision, visit, tmp_path):
    run = blue_cube()
    forces = {(other, "box"): force(200, (0, 200), value=20.0)}
    contact = ContactRecord((other, "box"), 0.0, 2.0, 20.0, is_collision)
    run = replace(changed(run, contact_forces=forces), contacts=(contact,))
    page = visit(write(tmp_path, run), "#t=1", has_scene=True).page
    page.click("#tools summary")
    for tool in ("path", "plan", "frame", "goal"):
        page.click(f"#tool-{tool}")
    wait_for_frame(page)
    found = page.evaluate(HUES)
    assert found["blue" if not is_collision else "other"] > 500
    assert (
        found["blue" if not is_collision else "other"]
        > 10 * found["other" if not is_collision else "blue"]
    )


def test_only_stages_that_failed_are_printed_in_red(visit, tmp_path):
    stages = [
        {"stage": name, "status": status, "code": "", "text": "why", "details": []}
        for name, status in (("reach", "passed"), ("path", "failed"), ("time", "not reached"))
    ]
    steps = (step("go", 0, 200, status="failed", error_code="X", explanation={"stages": stages}),)
    page = visit(write(tmp_path, make_run(steps=steps)), "#tab=planner").page
    colours = page.locator(".stages .reason").evaluate_all(
        "all => all.map((each) => getComputedStyle(each).color)"
    )
    red = page.locator(".stages .bad .reason").evaluate("each => getComputedStyle(each).color")
    assert [colour == red for colour in colours] == [False, True, False]
    assert page.locator("#steps .bad").count() == 1


@pytest.mark.nightly
def test_a_run_without_duration_says_so_where_plots_would_be(visit, tmp_path):
    page = visit(write(tmp_path, lift_run(1))).page
    assert "no simulated time" in page.inner_text("#plots")
    assert page.locator("#plots canvas").count() == 0
    page.click("#play")
    page.keyboard.press("End")


def test_a_failure_shows_its_stages_and_the_nearest_state(visit, tmp_path):
    file = tmp_path / "far.scenario.yaml"
    file.write_text(UNREACHABLE)
    result = run_case(file, report_dir=tmp_path / "run", stills=False)
    assert result.outcome == "failed"
    page = visit(result.page, f"{failure_place(result)}&tab=planner", has_scene=True).page
    assert page.locator("#steps .bad[aria-current]").count() == 1, "the terminal's link leads to it"
    assert page.locator(".stages li").count() == 5
    assert page.locator(".stages .bad b").first.inner_text() == "reach"
    assert "What to do" in page.inner_text("#panel-planner")
    with_state = page.locator("#view canvas").screenshot()
    page.click("#tools summary")
    page.click("#tool-goal")
    wait_for_frame(page)
    assert page.locator("#view canvas").screenshot() != with_state, "the orange robot has gone"
