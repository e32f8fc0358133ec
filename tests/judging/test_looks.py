"""When pictures are taken for an expectation, and for which samples each of them counts."""

from dataclasses import replace
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from harness.judging.expectations.always import Always
from harness.judging.placed import PlacedExpectation
from harness.judging.window import NotObservable, window_of
from harness.plugins.cameras.expectations.sees import Sees
from harness.plugins.cameras.watched import looks_of_expectations, period
from harness.recording.signals import CaptureRecord
from tests.cameras.camera_runs import eye
from tests.judging.synthetic_run import DT, make_run, step

N = 101
FILES = {
    str(count): cv2.imencode(".png", np.eye(9, dtype=np.uint8) * (np.arange(9) < count))[
        1
    ].tobytes()
    for count in range(10)
}
SEES = Sees(camera="eye", object="box", min_area=3, min_visible=0.4)


def capture(sample, count, **changes):
    """A picture with some pixels of the box, of ten that it would have."""
    given = {"files": {"segmentation": str(count)}, "labels": {"box": 1}, "outlines": {"box": 10}}
    return CaptureRecord("eye", sample * DT, sample, **{**given, **changes})


def run_with(*captures, rate=5.0, n=N):
    run = replace(make_run(n, steps=(step("go", 20, 41),)), captures=captures, files=FILES)
    return replace(run, cameras=(replace(eye(), update_rate=rate),))


def margins(*captures, spec=SEES, name="", **options):
    return spec.signal(window_of(run_with(*captures, **options), name))


@pytest.mark.parametrize(
    ("rate", "samples", "expected"),
    [(5.0, 101, 0.2), (30.0, 101, 0.2), (2.0, 101, 0.5), (5.0, 4001, 0.2), (5.0, 4201, 0.21)],
)
def test_pictures_are_taken_at_most_five_times_a_second_and_two_hundred_times(
    rate, samples, expected
):
    window = SimpleNamespace(times=np.arange(samples) * DT)
    assert period(SimpleNamespace(update_rate=rate), window) == pytest.approx(expected)


def test_a_bare_word_looks_at_the_end_and_others_all_along():
    run = run_with()
    for spec, step_id, expected in (
        (SEES, "", [100]),
        (SEES, "go", [40]),
        (SEES.model_copy(update={"for_": 0.1}), "go", [20, 40]),
        (SEES.model_copy(update={"within": 0.1}), "go", [20, 40]),
        (Always(predicate=SEES), "", [0, 20, 40, 60, 80, 100]),
        (Always(predicate=SEES, during="go"), "", [20, 40]),
        (Always(predicate=SEES), "later", []),
        (SEES.model_copy(update={"camera": "other"}), "", []),
    ):
        looks = looks_of_expectations(run, [PlacedExpectation(spec, step_id, 1)])
        assert [look.sample for look in looks] == expected
        assert {(look.camera, look.kinds) for look in looks} <= {("eye", ("segmentation",))}


def test_a_picture_counts_until_the_next_one_or_for_a_period():
    """The last of 101 samples has a picture; at 2 Hz each counts for 0.505 s at most."""
    found = margins(capture(10, 5), capture(40, 2), capture(100, 9), rate=2.0)
    assert found.applies is not None
    assert np.flatnonzero(~found.applies).tolist() == [*range(10), *range(91, 100)]
    # 5 of 10 pixels: a share of 0.1 of the 0.6 above 0.4, and 2 pixels of 3 more than required
    assert found.values[10:40] == pytest.approx((0.5 - 0.4) / (1 - 0.4))
    assert found.values[40:91] == pytest.approx((0.2 - 0.4) / 0.4)
    assert found.values[100] == pytest.approx((0.9 - 0.4) / (1 - 0.4))
    assert found.evidence(40).text == "eye sees 2 pixels of box of the 10 of its outline"
    assert found.evidence(95).text == "eye took no picture"


def test_no_more_than_the_whole_outline_is_seen_and_nothing_of_none():
    found = margins(capture(100, 9, outlines={"box": 8}))
    assert found.evidence(100).measures[1].value == 1.0
    blind = margins(capture(100, 0, outlines={}))
    assert blind.values[100] == -1.0
    assert blind.evidence(100).text == "eye does not see box"
    bare = margins(capture(100, 5, outlines={}))
    assert [measure.value for measure in bare.evidence(100).measures] == [0.0, 5.0]
    unlabelled = margins(capture(90, 4), capture(100, 9, labels={"cup": 1}))
    assert unlabelled.evidence(100).text == "eye does not see box"


def test_only_pictures_of_the_window_and_the_kind_count():
    other = replace(capture(40, 9), camera="other")
    color = capture(40, 9, files={"color": "9"})
    for pictures in ((), (other,), (color,), (capture(19, 9),), (capture(41, 9),)):
        with pytest.raises(NotObservable, match="took no segmentation picture"):
            margins(*pictures, name="go")
    with pytest.raises(NotObservable, match=r"is of t=0.390 s, and none of the end at t=0.400 s"):
        margins(capture(20, 9), capture(39, 9), capture(41, 9), name="go")
    assert margins(capture(20, 9), capture(40, 9), name="go").applies.all()
    with pytest.raises(NotObservable, match="the pictures know no 'box'"):
        margins(capture(100, 9, labels={"cup": 1}))
    with pytest.raises(NotObservable, match="no camera 'left'"):
        margins(capture(100, 9), spec=SEES.model_copy(update={"camera": "left"}))
