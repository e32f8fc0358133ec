"""The film of a run, decoded again, and what it shows when."""

from itertools import pairwise

import cv2
import numpy as np
import pytest

from harness.cli.main import main
from harness.plugins.cameras.film import draw_film, draw_moment
from harness.plugins.cameras.film_story import HELD, deciding_moment, frames_of
from harness.recording.film import decoded_film
from harness.recording.stored_run import StoredRun
from harness.recording.verdict import Measure, Verdict
from tests.judging.synthetic_run import lift_run, make_run, step

WAIT = """\
scenario: wait
robot: open_manipulator_x
steps: [{wait: 0.2 s}]
expect:
  - duration: {at_least: 2 s}
"""


def stored(run, *verdicts, outcome="passed"):
    return StoredRun(run, verdicts, outcome, "0" * 64, {})


def verdict(status, time, value=0.5):
    measure = Measure("value", value, 1.0, "<=", "1", time)
    return Verdict(f"{status} at {time}", status, 0.1, "1", time, measures=(measure,))


def test_a_film_shows_the_run_in_real_time_and_size():
    run = lift_run()
    film = list(decoded_film(draw_film(stored(run), (320, 180), 4.0)))
    assert len(film) == int(4 * run.duration) + 1
    assert film[0].shape == (180, 320, 3)
    assert all(frame.std() > 5 for frame in film), "an empty picture"
    assert np.abs(film[0].astype(int) - film[-1]).max() > 40, "something moves"


@pytest.mark.nightly
def test_equal_runs_have_equal_films():
    films = [draw_film(stored(lift_run()), (320, 180), 2.0) for _ in range(2)]
    assert films[0] == films[1]


@pytest.mark.parametrize("time", [0.0, 0.71, 1.99])
def test_a_film_stands_still_where_an_expectation_failed(time):
    frames = list(frames_of(stored(lift_run(), verdict("failed", time), outcome="failed"), 10.0))
    held = [frame for frame in frames if frame.moment is not None]
    assert [frame.repeats for frame in held] == [round(10 * HELD)]
    assert held[0].sample == pytest.approx(100 * time, abs=1)
    assert len(frames) == len(list(frames_of(stored(lift_run()), 10.0))) + 1
    samples = [frame.sample for frame in frames]
    assert all(b - a >= -10 for a, b in pairwise(samples)), "time goes on"


def test_every_picture_names_the_step_that_runs():
    last = step("three", 200, 200, status="not reached")
    run = make_run(steps=(step("one", 0, 100), step("two", 100, 200), last))
    shown = [frame.step.id for frame in frames_of(stored(run), 10.0) if frame.step]
    assert shown == ["one"] * shown.count("one") + ["two"] * shown.count("two")
    assert min(shown.count("one"), shown.count("two")) >= 9


def test_the_deciding_moment_is_the_first_listed_failure_or_else_the_least_room():
    passed = [verdict("passed", 0.3, 0.2), verdict("passed", 0.6, 0.9), verdict("passed", 0.9, 0.4)]
    assert deciding_moment(stored(lift_run(), *passed)).time == 0.6
    failed = [*passed, verdict("failed", 1.5), verdict("failed", 1.2)]
    assert deciding_moment(stored(lift_run(), *failed, outcome="failed")).time == 1.5
    end = deciding_moment(stored(lift_run()))
    assert (end.time, end.is_good) == (lift_run().duration, True)
    picture = cv2.imdecode(np.frombuffer(draw_moment(stored(lift_run()), (320, 180)), np.uint8), 1)
    assert picture.shape == (180, 320, 3)


def test_a_run_and_a_saved_run_get_a_film(tmp_path, capsys):
    file = tmp_path / "wait.scenario.yaml"
    file.write_text(WAIT)
    options = ["--film", "--no-page", "--in-process", "--report-dir", str(tmp_path / "out")]
    assert main(["run", str(file), *options]) == 1
    (folder,) = {each.parent for each in tmp_path.rglob("film.mp4")}
    assert (folder / "moment.jpg").stat().st_size > 1000
    capsys.readouterr()
    assert main(["film", str(folder), "--to", str(tmp_path / "again")]) == 0
    assert capsys.readouterr().out.splitlines()[0] == str(tmp_path / "again" / "film.mp4")
    assert (tmp_path / "again" / "film.mp4").read_bytes() == (folder / "film.mp4").read_bytes()
    assert main(["film", str(tmp_path)]) == 2
