"""The studio's answers: drags, pictures of the scene, mistakes, and the first picture."""

import resource
import subprocess
import sys
import time

import numpy as np
import pytest

from harness.core.resources import data_folder
from harness.core.spatial import SE3
from harness.plugins.studio.document import new_text
from tests.reporting.browser import wait_for

pytest.importorskip("django_static_ace_builds")
from tests.plugins.studio.conftest import serve  # noqa: F401 - a fixture

FLAGSHIP = data_folder("scenarios") / "lessons/03_ur_sixteen_steps.scenario.yaml"
UR3E = {"model": "ur3e", "gripper": "rh_p12_rn_a"}
HEADING = "studio, UR3e"
SECONDS = 10.0


def percentile(values, share=95):
    return f"{1e3 * np.percentile(values, share):.1f} ms"


@pytest.mark.benchmark
def test_how_fast_a_drag_is_answered(print_row, serve):  # noqa: F811
    served = serve(new_text("x", UR3E, "empty"))
    studio = served.studio
    studio.close()  # its thread; the benchmark takes its place
    start = SE3.from_xyz_rpy([0.25, -0.2, 0.45], [np.pi, 0, 0])
    walls, processors = [], []
    for angle in np.linspace(0, 4 * np.pi, 200):
        away = 0.12 + 0.5 * (angle > 3 * np.pi)  # the last quarter is out of reach
        shift = away * np.array([np.cos(angle), np.sin(angle), 0.8 * np.sin(2 * angle)])
        begin, used = time.perf_counter(), time.process_time()
        studio.answer_pose(SE3(start.rotation, start.translation + shift), explain=False)
        walls.append(time.perf_counter() - begin)
        processors.append(time.process_time() - used)
    print_row(HEADING, "drag answered, 95 %", percentile(walls), percentile(processors), "25 ms")


@pytest.mark.benchmark
def test_how_many_pictures_a_second_the_scene_gets(print_row, serve, browser):  # noqa: F811
    served = serve(new_text("x", UR3E, "empty"))
    page = browser.new_page()
    page.goto(served.address)
    wait_for(page, "document.querySelectorAll('.joint').length > 0")
    view, count = served.studio.view, []
    move = view.move
    view.move = lambda *arguments: (count.append(1), move(*arguments))
    used, begin = time.process_time(), time.perf_counter()
    while time.perf_counter() - begin < SECONDS:
        target = "35" if int(time.perf_counter() - begin) % 4 < 2 else "-35"
        page.fill('input[aria-label="shoulder_pan_joint number"]', target)
        page.press('input[aria-label="shoulder_pan_joint number"]', "Enter")
        page.wait_for_timeout(1500)
    lasted = time.perf_counter() - begin
    core = (time.process_time() - used) / lasted
    rate = f"{len(count) / lasted:.1f} /s"
    print_row(HEADING, "scene updates", rate, f"{100 * core:.0f} % of a core", "25 /s, 30 %")
    page.close()


@pytest.mark.benchmark
def test_how_fast_mistakes_are_shown(print_row, serve):  # noqa: F811
    text = FLAGSHIP.read_text()
    served = serve(text)
    served.studio.close()
    walls, processors = [], []
    for number in range(30):
        changed = text.replace("id: step_9", f"id: step_nine_{number}")
        begin, used = time.perf_counter(), time.process_time()
        served.studio.do_edit({"text": changed})
        walls.append(time.perf_counter() - begin)
        processors.append(time.process_time() - used)
    print_row(HEADING, "flagship checked, 95 %", percentile(walls), percentile(processors), "50 ms")


@pytest.mark.benchmark
def test_how_long_the_first_picture_takes(print_row, browser, tmp_path):
    begin = time.perf_counter()
    command = [sys.executable, "-m", "harness.cli", "studio", "ur3e", "--gripper", "rh_p12_rn_a"]
    command += ["--no-open", "--port", "0"]
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True) as process:
        address = process.stdout.readline().strip()
        served = time.perf_counter() - begin
        page = browser.new_page()
        page.goto(address)
        wait_for(page, "document.querySelectorAll('.joint').length > 0")
        shown = time.perf_counter() - begin
        page.close()
        process.terminate()
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = used.ru_utime + used.ru_stime
    times = f"{served:.2f} s, page {shown:.2f} s", f"{processor:.2f} s of a processor"
    print_row(HEADING, "first picture", *times, "3 s")
