"""sees: real pictures, of which some barely do not show it and some show nothing at all."""

from dataclasses import replace

import numpy as np
import pytest
from pydantic import ValidationError

from harness.core.spatial import SE3
from harness.judging.expectations.always import Always
from harness.judging.expectations.eventually import Eventually
from harness.judging.expectations.never import Never
from harness.judging.expectations.within_limits import WithinLimits
from harness.judging.judge import judge
from harness.judging.placed import PlacedExpectation
from harness.plugins.cameras.expectations.sees import Sees
from harness.plugins.formulas.expectations.until import Until
from harness.recording.run import ObjectRecord
from harness.reporting.margins import deciding_measures
from tests.cameras.camera_runs import (
    GREEN,
    ball,
    card,
    every,
    eye,
    pictures,
    run_with,
    verdict,
)
from tests.cameras.recorded_runs import an_object
from tests.judging.synthetic_run import step

AHEAD = (0.6, 0.0, 1.0)
BALL = ball("ball", AHEAD, 0.05)
HARDLY = "hardly observed"
FACING_BACK = SE3.from_xyz_rpy(AHEAD, (np.pi / 2, 0, -np.pi / 2))
"""A card ahead of the camera, turned towards it, upright."""


def marker(size, number=3):
    return card("card", {"id": number, "size": size}, FACING_BACK)


def seen(spec, *things, **options):
    run, objects = run_with([eye(**options)], things)
    return verdict(run, objects, spec)


SUBJECTS = {
    "object": ({"object": "ball"}, BALL),
    "color": ({"color": "red"}, BALL),
    "marker": ({"marker": 3}, marker(0.1)),
}


@pytest.mark.parametrize("kind", SUBJECTS)
def test_it_passes_down_to_the_last_pixel_and_fails_by_one_more(kind):
    words, thing = SUBJECTS[kind]
    plain = seen(Sees(camera="eye", **words), thing)
    assert plain.status == "passed"
    pixels = next(m for m in plain.measures if m.name.startswith("pixels"))
    assert (pixels.unit, pixels.comparison) == ("px", ">=")
    count = int(pixels.value)
    assert count > 100
    exact = seen(Sees(camera="eye", min_area=count, **words), thing)
    assert (exact.status, exact.margin) == ("passed", 0.0)
    short = seen(Sees(camera="eye", min_area=count + 1, **words), thing)
    assert (short.status, short.margin, short.unit) == ("failed", -1.0, "px")
    assert f"{count} pixels" in short.reason


@pytest.mark.parametrize("kind", SUBJECTS)
def test_a_camera_that_looks_the_other_way_sees_nothing(kind):
    words, thing = SUBJECTS[kind]
    answer = seen(Sees(camera="eye", **words), thing, target=(-1.0, 0.0, 1.0))
    assert answer.status == "failed"
    assert answer.measures[0].value == 0.0
    assert "does not see" in answer.reason


@pytest.mark.parametrize("kind", SUBJECTS)
def test_without_a_picture_nothing_can_be_said(kind):
    words, thing = SUBJECTS[kind]
    run, _ = run_with([eye()], [thing])
    (answer,) = judge(run, [PlacedExpectation(Sees(camera="eye", **words))])
    assert answer.status == "not observable"
    assert "took no" in answer.reason
    (answer,) = judge(run, [PlacedExpectation(Sees(camera="other", **words))])
    assert (answer.status, answer.reason) == (
        "not observable",
        "the record has no camera 'other'",
    )


@pytest.mark.parametrize("kind", SUBJECTS)
def test_in_a_step_that_was_not_reached_it_never_applied(kind):
    words, thing = SUBJECTS[kind]
    steps = (step("look", 0, 2, status="not reached"),)
    run, objects = run_with([eye()], [thing], steps=steps)
    answer = verdict(run, objects, Sees(camera="eye", **words), "look")
    assert answer.status == "not reached"


def test_a_half_hidden_object_barely_passes_or_barely_does_not():
    thing = an_object("thing", (0.02, 0.2, 0.2), (1.0, 0.0, 1.0), GREEN)
    for edge, status in ((-0.006, "passed"), (0.006, "failed")):
        wall = an_object("wall", (0.001, 2.0, 2.0), (0.495, edge / 2 - 1.0, 1.0), GREEN)
        answer = seen(Sees(camera="eye", object="thing", min_area=1), thing, wall)
        assert answer.status == status
        assert abs(answer.margin) < 0.06
        assert answer.unit == "1"
        (measure,) = deciding_measures(answer)
        assert measure.name == "visible share of thing"


def test_hue_is_a_range_that_may_go_through_zero():
    assert seen(Sees(camera="eye", color={"hue": ("340 deg", "20 deg")}), BALL).status == "passed"
    assert seen(Sees(camera="eye", color={"hue": ("20 deg", "340 deg")}), BALL).status == "failed"
    for every_hue in (("0 deg", "360 deg"), ("-20 deg", "340 deg"), ("-180 deg", "180 deg")):
        assert seen(Sees(camera="eye", color={"hue": every_hue}), BALL).status == "passed"
    grey = replace(BALL, shapes=(replace(BALL.shapes[0], rgba=(0.5, 0.48, 0.48, 1.0)),))
    assert seen(Sees(camera="eye", color="red"), grey).status == "failed"


def test_a_colour_is_called_by_its_name_or_that_colour():
    named = seen(Sees(camera="eye", color="red"), BALL)
    assert "pixels of a blob of red" in named.reason
    assert named.measures[0].name == "pixels of the largest red blob"
    hues = seen(Sees(camera="eye", color={"hue": (np.radians(340), np.radians(20))}), BALL)
    assert "pixels of a blob of that colour" in hues.reason


def test_two_small_blobs_are_not_one_large_one():
    pair = [ball("one", (0.6, 0.08, 1.0), 0.02), ball("two", (0.6, -0.08, 1.0), 0.02)]
    one = seen(Sees(camera="eye", color="red"), pair[0]).measures[0].value
    both = seen(Sees(camera="eye", color="red"), *pair).measures[0].value
    assert both == pytest.approx(one, abs=3)


def test_the_number_and_the_dictionary_of_a_marker_count():
    assert seen(Sees(camera="eye", marker=4), marker(0.1)).status == "failed"
    wrong = Sees(camera="eye", marker={"id": 3, "dictionary": "DICT_5X5_50"})
    assert seen(wrong, marker(0.1)).status == "failed"


def test_noise_of_the_lessons_camera_does_not_hide_a_marker():
    assert seen(Sees(camera="eye", marker=3), marker(0.1), noise_stddev=0.007).status == "passed"


def passing_by(n=201):
    """A ball that crosses the picture in two seconds, in it from 0.5 s to 1.5 s about."""
    rows = np.tile(BALL.pose.as_vector(), (n, 1))
    rows[:, 1] = np.linspace(-0.7, 0.7, n)
    return run_with([eye()], [BALL], n=n, poses={"ball": rows})


@pytest.mark.nightly
def test_temporal_words_watch_at_the_cameras_rate_up_to_five_hertz():
    run, objects = passing_by()
    sees = Sees(camera="eye", object="ball")
    assert verdict(run, objects, sees).status == "failed"  # at the end it has gone by
    came = verdict(run, objects, Eventually(predicate=sees))
    assert came.status == "passed"
    assert 0.4 <= came.time <= 1.6
    for spec in (Always(predicate=sees), Never(predicate=sees)):
        assert verdict(run, objects, spec).status == "failed"
    held = verdict(run, objects, Eventually(predicate=sees, **{"for": 0.6}))
    assert held.status == "passed"
    too_long = verdict(run, objects, Eventually(predicate=sees, **{"for": 1.4}))
    assert too_long.status == "failed"
    assert "at most" in too_long.reason


def test_a_slow_camera_watches_at_its_own_rate():
    run, objects = passing_by()
    run = replace(run, cameras=(replace(eye(), update_rate=1.0),))
    sees = Sees(camera="eye", object="ball")
    came = verdict(run, objects, Eventually(predicate=sees))
    assert (came.status, came.time) == ("passed", 1.0)
    assert verdict(run, objects, Until(predicate=WithinLimits(), until=sees)).status == "passed"


def test_a_picture_of_earlier_says_nothing_of_the_end():
    run, objects = passing_by()
    run = pictures(run, objects, every(sample=100))
    (answer,) = judge(run, [PlacedExpectation(Sees(camera="eye", object="ball"))])
    assert answer.status == "not observable"
    assert "t=1.000 s" in answer.reason
    assert "t=2.000 s" in answer.reason


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({}, "exactly one of `object`, `color` and `marker`"),
        ({"object": "a", "marker": 1}, "exactly one of `object`, `color` and `marker`"),
        ({"marker": 50}, "markers 0 to 49, not 50"),
        ({"color": {"min_value": 0.1}}, "exactly one of `named` and `hue`"),
        ({"color": {"hue": (340, 20)}}, "less than or equal to 6.28"),
        ({"color": {"hue": ("10 deg", "10 deg")}}, "ends where it begins"),
        ({"color": "red", "min_visible": 0.3}, "`min_visible` goes with `object`"),
    ],
)
def test_impossible_words_are_refused(words, message):
    with pytest.raises(ValidationError, match=message):
        Sees(camera="eye", **words)


@pytest.mark.parametrize(
    ("opacity", "status"), [(0.0, "failed"), (0.09, "failed"), (0.1, "passed")]
)
def test_what_hardly_differs_from_the_background_is_not_seen(opacity, status):
    faint = ball("ball", AHEAD, 0.05, rgba=(1.0, 0.0, 0.0, opacity))
    run, objects = run_with([eye()], [faint])
    run = replace(run, objects=(ObjectRecord.of(faint, ((0.0, 1.0),), None),))
    answer = verdict(run, objects, Sees(camera="eye", object="ball"))
    assert answer.status == status
    assert (f"opacity is {opacity:g}" in answer.reason) == (status == "failed")


@pytest.mark.parametrize(
    ("rate", "samples", "names"),
    [
        (0.4, 200, ["hardly observed"]),
        (5.0, 200, []),
        (0.4, 21, []),
        (0.4, 22, ["hardly observed"]),
    ],
)
def test_few_pictures_of_a_long_time_are_warned_of(rate, samples, names):
    run, objects = run_with([eye(update_rate=rate)], [BALL], n=samples)
    answer = verdict(run, objects, Always(predicate=Sees(camera="eye", object="ball")))
    assert answer.status == "passed"
    assert [warning.name for warning in answer.warnings] == names


@pytest.mark.parametrize(("y", "names"), [(0.0, None), (0.42, ["partly seen"]), (0.6, [])])
def test_never_warns_of_what_is_partly_in_the_picture(y, names):
    thing = ball("ball", (0.6, y, 1.0), 0.15)
    run, objects = run_with([eye()], [thing], n=10)
    answer = verdict(run, objects, Never(predicate=Sees(camera="eye", object="ball")))
    assert answer.status == ("failed" if names is None else "passed")
    assert [warning.name for warning in answer.warnings] == (names or [])
