"""Predicates that a package adds: bare margins are shown with the bound and the unit they state."""

from typing import Any, ClassVar

import numpy as np
import pytest

from harness.expectations import (
    Expectation,
    Length,
    ObjectPredicate,
    Observations,
    Predicate,
    Quantity,
    frame_poses,
)
from harness.judging.observations import ExpectationError, UndeclaredObservation
from harness.judging.placed import as_expectation
from harness.language.expectation import ExpectationFields
from harness.plugins.objects.expectations.displaced import Displaced
from tests.judging.evidence_runs import travelling
from tests.judging.synthetic_run import BOX, TABLE, at, make_run, thing, verdict


class TcpHeight(Predicate):
    """The TCP is at least, or at most, this high."""

    at_least: Length | None = None
    at_most: Length | None = None

    def signal(self, window):
        z = window.tcp_position[:, 2]
        return z - self.at_least if self.at_most is None else self.at_most - z


class TcpBand(Predicate):
    """The TCP is between two heights."""

    at_least: Length
    at_most: Length

    def signal(self, window):
        z = window.tcp_position[:, 2]
        return np.minimum(z - self.at_least, self.at_most - z)


class BoxHeight(ObjectPredicate):
    """The object is high."""

    at_least: Length

    def signal(self, window):
        return window.cut(window.run.signals.object_poses[self.object])[:, 2] - self.at_least


def answer_of(spec, length=0.4):
    """The verdict on a TCP that rises from the ground to a height."""
    return verdict(travelling(length), spec)


@pytest.mark.parametrize(
    ("spec", "status", "margin", "value", "comparison", "reason"),
    [
        (
            TcpHeight(at_least=0.25), "passed", 0.15, 0.4, ">=",
            "tcp height is 400 mm, at least 250 mm required at t=1.990 s",
        ),
        (
            TcpHeight(at_most=0.25), "failed", -0.15, 0.4, "<=",
            "tcp height is 400 mm, at most 250 mm required at t=1.990 s",
        ),
        (TcpHeight(at_least=0.4), "passed", 0.0, 0.4, ">=", "tcp height is 400 mm, at least"),
        (
            TcpBand(at_least=0.1, at_most=0.45), "passed", 0.05, 0.05, ">=",
            "the margin of tcp band is 50.0 mm, at least 0 mm required",
        ),
        (
            TcpBand(at_least=0.1, at_most=0.35), "failed", -0.05, -0.05, ">=",
            "the margin of tcp band is -50.0 mm, at least 0 mm required",
        ),
    ],
)  # fmt: skip
def test_a_bound_is_shown_with_its_value_and_its_unit(
    spec, status, margin, value, comparison, reason
):
    answer = answer_of(spec)
    assert (answer.status, answer.unit) == (status, "m")
    assert answer.margin == pytest.approx(margin)
    (measure,) = answer.measures
    assert measure.value == pytest.approx(value)
    assert measure.value - measure.limit == pytest.approx(margin if comparison == ">=" else -margin)
    assert measure.comparison == comparison
    assert answer.reason.startswith(reason)


def test_what_is_measured_follows_from_the_bounds():
    (quantity,) = TcpHeight.quantities
    holds = "at least `at_least`, at most `at_most`"
    assert quantity == Quantity("tcp height", "m", holds)
    assert TcpBand.quantities == (Quantity("tcp band", "m", holds),)
    assert BoxHeight.quantities == (Quantity("box height", "m", "at least `at_least`"),)


def test_an_object_that_is_not_recorded_yet_is_not_reached_by_a_bare_margin():
    poses = at(200, (0, 0, 0.5))
    poses[:100] = np.nan
    late = thing("late")
    late = type(late)(**{**vars(late), "present": ((1.0, 1e9),)})
    run = make_run(objects=(TABLE, BOX, late), object_poses={"late": poses})
    answer = verdict(run, BoxHeight(object="late", at_least=0.4))
    assert (answer.status, answer.observed.samples, answer.observed.unknown) == ("passed", 100, 0)
    gone = make_run(object_poses={"box": np.where(np.arange(200)[:, None] < 50, np.nan, at(200))})
    answer = verdict(gone, BoxHeight(object="box", at_least=-0.1))
    assert (answer.observed.samples, answer.observed.unknown) == (150, 50), "it was there"


@pytest.mark.parametrize(
    ("returned", "said"),
    [
        (1.0, r"of shape \(\), not one margin for each of 200 samples"),
        (np.zeros(199), r"of shape \(199,\), not one margin for each of 200 samples"),
        (np.zeros((200, 1)), r"of shape \(200, 1\), not one"),
    ],
)
def test_margins_of_another_shape_are_an_error_of_the_class(returned, said):
    class Shaped(Predicate):
        """A mistake."""

        at_least: Length
        shape: ClassVar[Any] = returned

        def signal(self, window):  # noqa: ARG002 - it returns the same for every window
            return self.shape

    with pytest.raises(ExpectationError, match=rf"Shaped.signal returns an array {said}"):
        answer_of(Shaped(at_least=0.1))


def test_a_signal_that_raises_is_an_error_of_the_class():
    class Raising(Predicate):
        """A mistake."""

        at_least: Length

        def signal(self, window):
            return window.times[10_000]

    with pytest.raises(ExpectationError, match=r"Raising.signal raised IndexError: index 10000"):
        answer_of(Raising(at_least=0.1))


@pytest.mark.parametrize(
    ("read", "declared", "said"),
    [
        ("frames", Observations(), "the pose of the link 'arm_link'"),
        ("clearances", Observations(planned_clearances=True), "distances"),
        ("clearance_links", Observations(), "distances"),
        ("planned_clearances", Observations(clearance_cutoff=0.1), "planned distances"),
        ("captures", Observations(clearance_cutoff=0.1), "camera pictures"),
        ("frames", Observations(frozenset({"arm_link"})), ""),
        ("clearances", Observations(clearance_cutoff=0.0), ""),
        ("clearance_links", Observations(clearance_cutoff=0.1), ""),
        ("planned_clearances", Observations(planned_clearances=True), ""),
    ],
)
def test_a_predicate_reads_what_it_declares(read, declared, said):
    class Reading(Predicate):
        """It reads something."""

        at_least: Length

        def observations(self):
            return declared

        def signal(self, window):
            signals = window.run.signals
            if read == "frames":
                assert list(signals.frames) == ["arm_link"] * len(declared.frames)
                assert len(signals.frames) == len(declared.frames)
                assert "arm_link" in signals.frames
                return frame_poses(window.run, "arm_link")[:, 2] - self.at_least
            return np.full(200, len(window.run.captures if read == "captures" else
                                    getattr(signals, read)) - 0.5)  # fmt: skip

    run = make_run(
        frames={"arm_link": at(200, (0, 0, 0.5)), "palm": at(200)},
        clearances={("robot", "box"): np.ones(200)},
        clearance_links={("robot", "box"): np.ones(200, dtype=int)},
        planned_clearances={("robot", "box"): np.ones(200)},
    )
    if not said:
        assert verdict(run, Reading(at_least=0.1)).status == "passed"
        return
    with pytest.raises(UndeclaredObservation) as caught:
        verdict(run, Reading(at_least=0.1))
    assert str(caught.value) == (
        f"Reading reads {said}, which its method `observations` does not declare"
    )
    assert caught.value.predicate == "Reading"


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ({"at_least": (Length, ...)}, "the predicate Wrong has no method `signal`"),
        ({"signal": lambda *_: None}, "the predicate Wrong does not say what it measures"),
        (
            {"signal": lambda *_: None, "at_least": (Length, ...), "at_most": (float, ...)},
            "the predicate Wrong does not say what it measures",
        ),
    ],
)
def test_a_class_that_forgets_something_is_refused(body, said):
    annotations = {key: value[0] for key, value in body.items() if isinstance(value, tuple)}
    methods = {key: value for key, value in body.items() if not isinstance(value, tuple)}
    with pytest.raises(TypeError, match=said):
        type(
            "Wrong",
            (Predicate,),
            {
                **methods,
                "__annotations__": annotations,
                "__doc__": "Wrong.",
                "__module__": __name__,
            },
        )


def test_an_expectation_needs_a_verdict_and_a_class_of_its_own():
    class Empty(Expectation):
        """Nothing."""

    with pytest.raises(NotImplementedError, match="Empty has no method `verdict`"):
        verdict(make_run(), Empty())
    assert as_expectation(Displaced(object="box")) == Displaced(object="box")
    with pytest.raises(TypeError, match="ExpectationFields is no subclass of Expectation"):
        as_expectation(ExpectationFields())
