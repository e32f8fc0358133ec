"""Which recorded distances two words mean, and where one of them is not known."""

from dataclasses import replace

import numpy as np
import pytest

from harness.judging.distances import recorded_distances
from harness.judging.window import NotObservable, NotReached
from harness.plugins.arms.expectations.clearance import unknown_distances
from tests.judging.synthetic_run import BOX, TABLE, at, attachment, lift_run, make_run, thing

N = 40
CUP = thing("cup")
KEYS = (("box", "Table"), ("cup", "Table"), ("robot", "Table"), ("robot", "box"),
        ("robot", "robot"))  # fmt: skip


def where(mask):
    return np.flatnonzero(mask).tolist()


def made(*keys, **changes):
    given = {
        "objects": (TABLE, BOX, CUP),
        "object_poses": {"cup": at(N)},
        "clearances": {key: np.full(N, 0.1 * len(key[0])) for key in keys},
        **changes,
    }
    return make_run(N, **given)


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        ("robot", "any", [("robot", "Table"), ("robot", "box")]),
        ("any", "robot", [("robot", "Table"), ("robot", "box")]),
        ("box", "any", [("box", "Table")]),
        ("any", "cup", [("cup", "Table")]),
        ("robot", "box", [("robot", "box")]),
        ("box", "robot", [("robot", "box")]),
        ("robot", "robot", [("robot", "robot")]),
        ("Table", "box", [("box", "Table")]),
        ("box", "Table", [("box", "Table")]),
    ],
)
def test_words_choose_pairs_in_either_order(first, second, expected):
    found = recorded_distances(made(*KEYS), first, second)
    assert list(found) == expected
    for key, values in found.items():
        assert values.tolist() == made(*KEYS).signals.clearances[key].tolist()


def test_an_attached_object_means_its_stand_in_too():
    stand_in = thing("belief", physics=False)
    record = attachment("belief", 5, 20, represents="box")
    run = made(("belief", "Table"), ("box", "cup"), objects=(TABLE, BOX, CUP, stand_in),
               attachments=(record,))  # fmt: skip
    assert list(recorded_distances(run, "box", "Table")) == [("belief", "Table")]
    assert list(recorded_distances(run, "belief", "any")) == [("belief", "Table"), ("box", "cup")]
    older = replace(run, unrecorded=("attachments",))
    assert list(recorded_distances(older, "belief", "any")) == [("belief", "Table")]
    assert list(recorded_distances(older, "box", "any")) == [("box", "cup")]


def test_what_the_hand_holds_is_not_any_other_body():
    run = lift_run(clearances={("robot", "box"): np.ones(200), ("robot", "Table"): np.ones(200)})
    found = recorded_distances(run, "robot", "any")
    assert where(np.isnan(found["robot", "box"])) == list(range(50, 200))
    assert np.isfinite(found["robot", "Table"]).all()
    assert np.isfinite(recorded_distances(run, "robot", "box")["robot", "box"]).all()


def test_a_distance_that_was_not_recorded_says_why():
    with pytest.raises(NotObservable, match="between the robot and objects"):
        recorded_distances(made(), "robot", "any")
    with pytest.raises(NotReached, match="no other body than robot"):
        recorded_distances(made(objects=()), "any", "robot")
    with pytest.raises(NotReached, match="no other body than box"):
        recorded_distances(made(), "any", "box")
    with pytest.raises(NotReached, match="held neither box nor cup"):
        recorded_distances(made(), "box", "cup")
    never = replace(CUP, present=())
    for pair in (("robot", "cup"), ("cup", "robot"), ("cup", "box"), ("box", "cup")):
        with pytest.raises(NotReached, match="cup was never in the scene"):
            recorded_distances(made(objects=(TABLE, BOX, never)), *pair)
    for pair in (("robot", "cup"), ("robot", "robot"), ("box", "cup"), ("cup", "box")):
        with pytest.raises(NotObservable, match="was not recorded"):
            recorded_distances(made(attachments=(attachment("box", 5, 20),)), *pair)


@pytest.mark.parametrize(
    ("key", "expected"),
    [
        (("robot", "robot"), range(N)),
        (("robot", "box"), [*range(5), *range(20, N)]),  # not while the hand holds it
        (("robot", "lid"), range(N)),  # the planner alone believes that the hand does
        (("robot", "plan"), [*range(5), *range(21, N)]),  # neither while attached nor at its end
        (("robot", "cup"), range(10, 31)),
        (("box", "Table"), range(5, 20)),
        (("box", "cup"), range(10, 20)),
        (("cup", "box"), []),
    ],
)
def test_a_distance_is_unknown_where_it_exists_and_is_missing(key, expected):
    cup = replace(CUP, present=((0.1, 0.3),))
    run = make_run(
        N,
        objects=(TABLE, BOX, cup, thing("lid"), thing("plan", physics=False)),
        object_poses={"cup": at(N), "lid": at(N)},
        attachments=(
            attachment("box", 5, 20, is_welded=True),
            attachment("lid", 5, 20),
            attachment("plan", 5, 20),
        ),
        clearances={key: np.full(N, np.nan)},
    )
    assert where(unknown_distances(run, key)) == list(expected)
    known = replace(run, signals=replace(run.signals, clearances={key: np.zeros(N)}))
    assert not unknown_distances(known, key).any()


def test_without_a_record_of_attachments_a_distance_exists_wherever_the_object_is():
    box = attachment("box", 5, 20, is_welded=True)
    run = made(attachments=(box,), clearances={("robot", "box"): [np.nan] * N})
    assert not unknown_distances(run, ("robot", "box"))[10]
    older = replace(run, unrecorded=("attachments",))
    assert unknown_distances(older, ("robot", "box")).all()
