"""Names and texts that try to be markup, are very long, or are in any script."""

from dataclasses import replace

import pytest

from harness.core.camera import Camera
from harness.core.geometry import Box
from harness.recording.run import Finding
from harness.recording.signals import CaptureRecord
from harness.recording.stored_run import StoredRun
from harness.recording.verdict import Measure, Verdict
from harness.reporting.html.summary import SummaryPicture
from harness.reporting.html.write import Page
from harness.robot.description import PlanningGroup
from tests.judging.synthetic_run import TABLE, lift_run, step, thing

TAKE_OVER = "document.title='taken'"
ATTACK = (
    f"\"'`</script><script>{TAKE_OVER}</script><!--<script>]]>${{{TAKE_OVER}}}$data"
    f'<img src=x onerror="{TAKE_OVER}"><svg onload="{TAKE_OVER}"></style></textarea>&lt;b&gt;'
)
LETTERS = "kar robotyczny ramię über 漢字 العربية \u202eright to left\u202c \u2028 \x00 \udcff 🤖"
LONG = "a_name_without_any_place_to_break_it_" * 12
NAMES = {"attack": f"{ATTACK}{LETTERS}", "long": LONG}


def hostile_run(name):
    """Everything in it that a user can name has the name."""
    run = lift_run(
        objects=(TABLE, thing("box"), thing(name, Box((0.1, 0.1, 0.1)), physics=False)),
        steps=(
            replace(
                step(name, 0, 100, message=name, error_code=name, status="failed"), summary=name
            ),
            step("late", 100, 200, planner={name: name, "planner_id": name}),
        ),
        contact_forces={(name, "box"): lift_run().signals.contact_forces["left_finger", "box"]},
    )
    joints = tuple(
        replace(each, name=name) if each.name == "shoulder" else each for each in run.robot.joints
    )
    groups = {**run.robot.groups, "arm": PlanningGroup("arm", (name,))}
    robot = replace(run.robot, name=name, joints=joints, groups=groups)
    return replace(
        run, scenario=name, file=f"{name}.yaml", case=name, robot=robot, source=f"{name}\n# {name}",
        findings=(Finding(name, name, 0.5, name),), versions={name: name, "mujoco": name},
        ended_early=name, cameras=(Camera(name, name),),
        captures=(CaptureRecord(name, 0.5, 50, name, backend=name, files={"color": "a.png"}),),
        files={"a.png": b"no picture"},
    )  # fmt: skip


def page_of(name, folder):
    measure = Measure(name, 2.0, 1.0, "<=", name, 0.5, name)
    verdict = Verdict(name, "failed", -1.0, name, 0.5, 1, name, name, (measure,))
    stored = StoredRun(hostile_run(name), (verdict,), "failed", "0" * 64, {name: 1.0})
    file = folder / "report.html"
    text = Page(stored.run, stored.verdicts).html(stored, [SummaryPicture(name, b"")])
    file.write_text(text, encoding="utf-8", newline="")
    return file


@pytest.mark.nightly(but=["attack-1100"])
@pytest.mark.parametrize("width", [390, 1100])
@pytest.mark.parametrize("name", NAMES.values(), ids=NAMES)
def test_no_name_becomes_markup_or_breaks_the_page(visit, tmp_path, name, width):
    file = page_of(name, tmp_path)
    assert file.read_text(encoding="utf-8").count("<script") == 3, "only the page's own"
    opened = visit(file, width=width, has_scene=True)
    page = opened.page
    for tab in ("expect", "planner", "findings", "source", "joints", "environment"):
        page.click(f"#tab-{tab}")
        assert page.evaluate("document.documentElement.scrollWidth") <= width, tab
    page.click(".step >> nth=0")
    page.click("#tab-expect")
    page.click(".verdict >> nth=0")
    assert opened.time() == pytest.approx(0.5, abs=2e-3)
    assert page.title() != "taken"
    assert page.locator("#app img, #app script, #app svg, #app style").count() == 0
    shown = page.locator(".step b").first.text_content()
    assert shown == name.replace("\udcff", "?")


def test_an_attack_is_harmless_without_scripts_too(visit, tmp_path):
    page = visit(page_of(ATTACK, tmp_path), scripts=False).page
    assert page.locator("#summary").is_visible()
    assert page.locator("#summary script, #summary svg, #summary img:not([alt=''])").count() == 0
