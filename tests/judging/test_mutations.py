"""Every signal that a predicate reads, corrupted in every way: no verdict may go on passing.

Nothing here is picked by hand but one passing run for each predicate, with a time before its window
in which the predicate did not hold. What a predicate reads is traced while it is judged; each of
those signals is then shifted, frozen, dropped and made NaN:

- shift: from the window's start on, at once or as a drift of so much a second, either way in each
  column of its own (poses along and about each axis), by sizes from small to large: every one
  larger than the first that is noticed must be noticed too, and there must be one. `FREE` lists,
  with their reasons, the directions that a predicate does not cover; none of them may be
  noticed, so that the list says no more than is so. `MEASURED` are directions in which a signal
  is what is measured: there the margin is exactly how far it may go;
- freeze: it keeps its value from some moment on; at least one moment must be noticed, which is one
  at which the predicate did not hold;
- drop: it was not recorded, and neither was its kind, where a missing key means "never touched";
- NaN: none of its samples is known;
- hole: it is not known for 0.3 s; at least one such hole must be noticed;
- two sources: every other sample is the signal's first one, as if a publisher that hangs wrote to
  the same topic; noticed when either the odd or the even samples are;
- swap: two signals of its kind are exchanged, as two objects with each other's names are;
- swap midway: from some moment on, as by a tracker that confuses two objects; at least one moment
  must be noticed;
- glued: an object keeps its place in the hand from some moment on, whatever the contacts say; at
  least one moment must be noticed.

A mutant that equals the original is none, and `SAME_THING` lists those that are what the predicate
covers: a stuck signal looks like a thing that stands still. `SHOWN_ONLY` lists what
moves a margin and decides nothing, with the reason; there a mutant is noticed when the margin is
another one.
"""

from dataclasses import fields, replace

import numpy as np
import pytest

from harness.core.pose_arrays import compose, relative
from harness.judging.expectations.duration import DurationCheck
from harness.judging.expectations.lifted import Lifted
from harness.judging.judge import judge
from harness.judging.placed import PlacedExpectation
from harness.language.language import PREDICATES
from harness.plugins.formulas.expectations.until import Until
from harness.plugins.paths.expectations.fraction import FractionCheck
from harness.recording.signals import Signals
from harness.recording.step_results import SavedResult
from tests.judging.evidence import AT_ONCE, COURSES, collected
from tests.judging.evidence_runs import N
from tests.judging.free_shifts import FREE, free_shifts
from tests.judging.picture_mutants import SUBJECTS, corrupted, seen_run
from tests.judging.signal_shifts import array_of, directions, shifted, with_array
from tests.judging.synthetic_run import lift_run

MOMENTS = range(0, N, 10)
HOLE = 30
"""Samples of a hole: 0.3 s, longer than any gap that a verdict bridges."""
FORCES_AND_DISTANCES = (
    *("contact_forces", "presses", "frictions", "support_forces", "slides"),
    *("clearances", "planned_clearances", "link_overlaps"),
)
MAPPINGS = ("frames", "object_poses", "wrenches", *FORCES_AND_DISTANCES)
SHOWN_ONLY = {
    ("collision", "clearances"): "contacts decide; how near it came is the margin of what did not"
}
IN_DOUBT = ("hole", "two sources")
"""Mutations that leave most of what is only shown as it was."""
SAME_THING = {
    ("within_limits", "joint_commands", "drop"): "measured joints are judged in a recording without"
    " commands, too",
    (
        "static",
        "object_poses",
        "freeze",
    ): "a pose that does not change is a thing that stands still",
    ("within_limits", "joint_command_velocities", "freeze"): "a velocity that does not change is no"
    " acceleration",
    **{
        (word, "object_poses", kind): "the other object stands still, upright and low, too"
        for word in ("upright", "static", "formula")
        for kind in ("swap", "swap midway")
    },
    **{
        (word, "presses", kind): "where the fingers press, and not which finger presses where"
        for word in ("lifted", "grasped", "slip", "until")
        for kind in ("swap", "swap midway")
    },
    ("static", "object_poses", "glued"): "the hand stands still at the end, too",
    (
        "until",
        "object_poses",
        "glued",
    ): "the contact says that the box left the table, wherever that is",
    ("lifted", "contact_forces", "hole"): "the hand carries the box, whatever else touches it",
    ("in_contact", "contact_forces", "hole"): "one moment of contact is enough",
    **{
        ("in_contact", "contact_forces", kind): "the other pair touches at some moment, too"
        for kind in ("swap", "swap midway")
    },
    ("formula", "object_poses", "hole"): "one moment of speed is enough",
    **{
        ("slip", signal, kind): "another sample at which both fingers hold is the reference"
        for signal in ("contact_forces", "presses")
        for kind in ("hole", "swap", "swap midway")
    },
    **{
        (word, signal, "two sources"): "a gap of one sample in a contact is bridged, as physics"
        " has them; two publishers are found when a recording is imported"
        for word in ("lifted", "grasped", "slip", "until", "placed", "on", "in_contact")
        for signal in ("contact_forces", "presses", "frictions", "support_forces")
    },
    **{
        (word, signal, "two sources"): "what one moment decides, or gaps of one sample do not; two"
        " publishers are found when a recording is imported"
        for word, signal in (
            ("lifted", "object_poses"),
            ("lifted", "tcp_pose"),
            ("formula", "object_poses"),
            ("formula", "tcp_pose"),
            ("tcp_path", "tcp_pose"),
        )
    },
}
COMES_BACK = {
    ("displaced", "+x"): "first to where it was, then past it",
    **{
        (case, way): "past the other finger, as in a ring that is held from inside"
        for case in ("lifted", "grasped", "slip", "until")
        for way in ("+y", "-y")
    },
}
TABLE_BOX, ROBOT_BOX = ("Table", "box"), ("robot", "box")
MEASURED = [
    ("lifted", ("object_poses", "box"), "-z"),
    ("released", ("contact_forces", ("left_finger", "box")), "+"),
    ("placed", ("object_poses", "box"), "+-x"),
    ("placed", ("object_poses", "box"), "+-y"),
    ("placed", ("object_poses", "box"), "+-z"),
    ("on", ("contact_forces", TABLE_BOX), "-"),
    ("on", ("support_forces", TABLE_BOX), "-"),
    ("in", ("object_poses", "bin"), "+-roll"),
    ("in", ("object_poses", "bin"), "+-pitch"),
    ("displaced", ("object_poses", "box"), "+x"),
    ("upright", ("object_poses", "box"), "+-roll"),
    ("upright", ("object_poses", "box"), "+-pitch"),
    ("static 2", ("joint_velocities", None), "+-finger"),
    ("in_contact", ("contact_forces", ("left_finger", "box")), "-"),
    ("clearance", ("clearances", ROBOT_BOX), "-"),
    ("clearance 2", ("clearances", ROBOT_BOX), "-"),
    ("clearance 2", ("planned_clearances", ROBOT_BOX), "+"),
    ("tcp_pose", ("tcp_pose", None), "+-x"),
    ("tcp_pose", ("object_poses", "box"), "+-z"),
    ("tcp_pose 2", ("frames", "arm_link"), "+-y"),
    ("joints", ("joint_positions", None), "+-finger"),
    ("named_target", ("joint_positions", None), "+-shoulder"),
    ("gripper", ("joint_positions", None), "+-finger"),
    ("within_limits", ("joint_positions", None), "+finger"),
    ("within_limits 2", ("joint_positions", None), "-finger"),
    ("tracking_error", ("joint_positions", None), "+-shoulder"),
    ("tracking_error", ("joint_commands", None), "+-shoulder"),
    ("formula", ("tcp_pose", None), "-z"),
    ("formula 3", ("clearances", ROBOT_BOX), "-"),
]


def name_of(spec):
    inner = spec if isinstance(spec, Until) else getattr(spec, "predicate", spec)
    return inner.word


CASES = [case for evidence in collected() for case in evidence.mutation_cases]


def names_of_cases():
    """A predicate's name, and from its second case on a number."""
    names = [name_of(spec) for spec, _, _ in CASES]
    numbers = [names[: index + 1].count(name) for index, name in enumerate(names)]
    return [f"{n} {k}" if k > 1 else n for n, k in zip(names, numbers, strict=True)]


NAMED = dict(zip(names_of_cases(), CASES, strict=True))


class _Traced(dict):
    """A mapping that notes which of its values are read."""

    def __init__(self, name, values, read):
        super().__init__(values)
        self.name, self.read = name, read

    def __getitem__(self, key):
        self.read.add((self.name, key))
        return super().__getitem__(key)

    def items(self):
        self.read |= {(self.name, key) for key in self}
        return super().items()


class _TracedSignals:
    def __init__(self, signals):
        self.signals, self.read = signals, set()

    def __getattr__(self, name):
        value = getattr(self.signals, name)
        if name in MAPPINGS:
            return _Traced(name, value, self.read)
        if isinstance(value, np.ndarray) and name != "times":
            self.read.add((name, None))
        return value


def answer(run, spec, step_id):
    (verdict,) = judge(run, [PlacedExpectation(spec, step_id)])
    return verdict


def read_by(run, spec, step_id):
    """Names of the arrays that a verdict comes from, as (field, key)."""
    traced = _TracedSignals(run.signals)
    answer(replace(run, signals=traced), spec, step_id)
    return sorted(traced.read, key=repr)


def frozen(run, place, _):
    array = array_of(run.signals, place)
    for moment in MOMENTS:
        stuck = array.copy()
        stuck[moment:] = array[moment]
        if not np.array_equal(stuck, array, equal_nan=True):
            yield with_array(run, place, stuck)


def dropped(run, place, _):
    field, key = place
    if key is None or field in FORCES_AND_DISTANCES:
        empty = {} if key is not None else np.full_like(array_of(run.signals, place), np.nan)
        lost = replace(run.signals, **{field: empty})
        yield replace(run, signals=lost, unrecorded=(field,))
    else:
        rest = {k: v for k, v in getattr(run.signals, field).items() if k != key}
        yield replace(run, signals=replace(run.signals, **{field: rest}))


def unknown(run, place, _):
    yield with_array(run, place, np.full_like(array_of(run.signals, place), np.nan))


def with_holes(run, place, _):
    array = array_of(run.signals, place)
    for moment in MOMENTS:
        holed = array.copy()
        holed[moment : moment + HOLE] = np.nan
        yield with_array(run, place, holed)


def from_two_sources(run, place, start):
    array = array_of(run.signals, place)
    for first in (start, start + 1):
        mixed = array.copy()
        mixed[first::2] = array[0]
        if not np.array_equal(mixed, array, equal_nan=True):
            yield with_array(run, place, mixed)


def swapped(run, place, _):
    field, key = place
    if key is None:
        return
    mapping = getattr(run.signals, field)
    for other, values in mapping.items():
        if not np.array_equal(values, mapping[key], equal_nan=True):
            changed = {**mapping, key: values, other: mapping[key]}
            yield replace(run, signals=replace(run.signals, **{field: changed}))


def swapped_midway(run, place, _):
    field, key = place
    if key is None:
        return
    mapping = getattr(run.signals, field)
    for other, values in mapping.items():
        for moment in MOMENTS:
            ours, theirs = mapping[key].copy(), values.copy()
            ours[moment:], theirs[moment:] = values[moment:], mapping[key][moment:]
            if not np.array_equal(ours, mapping[key], equal_nan=True):
                changed = {**mapping, key: ours, other: theirs}
                yield replace(run, signals=replace(run.signals, **{field: changed}))


def glued(run, place, _):
    if place[0] != "object_poses":
        return
    array, tcp = array_of(run.signals, place), run.signals.tcp_pose
    for moment in MOMENTS:
        stuck = array.copy()
        stuck[moment:] = compose(tcp[moment:], relative(tcp[moment], array[moment]))
        if not np.allclose(stuck, array, atol=1e-12, equal_nan=True):
            yield with_array(run, place, stuck)


MUTATIONS = {
    "freeze": frozen,
    "drop": dropped,
    "NaN": unknown,
    "hole": with_holes,
    "two sources": from_two_sources,
    "swap": swapped,
    "swap midway": swapped_midway,
    "glued": glued,
}


def other_report(value):
    """Another value that a step could have reported."""
    match value:
        case bool():
            return not value
        case int() | float():
            return value - 0.5
        case _:
            return value


def reported(run, spec):
    """Mutants of what steps report, and of how long they took."""
    for kind, change in (
        ("shift", other_report),
        ("drop", None),
        ("NaN", lambda _: float("nan")),
    ):
        steps = [
            replace(
                each,
                end_time=each.end_time if kind != "shift" else each.end_time + 0.5,
                result=SavedResult(
                    verb=each.verb,
                    saved={key: change(value) for key, value in each.result.plain().items()}
                    if change
                    else {},
                ),
            )
            for each in run.steps
        ]
        if kind == "drop" and isinstance(spec, DurationCheck):
            steps = []
        if kind == "NaN":
            steps = [replace(each, end_time=float("nan")) for each in steps]
        yield kind, replace(run, steps=tuple(steps))


def start_of(run, step_id):
    """The first sample of a window."""
    return next((each.start_index for each in run.steps if each.id == step_id), 0)


def unnoticed_shifts(case, place):
    """Shifts of an array that are not noticed and not listed, or listed in vain."""
    spec, run, step_id = NAMED[case]
    free = free_shifts(case, place)
    for direction in directions(run, place):
        for course in COURSES:
            mutants = shifted(run, place, start_of(run, step_id), direction, course)
            noticed = [answer(mutant, spec, step_id).status != "passed" for mutant in mutants]
            what = f"{case} / {place[0]} {place[1] or ''} / {direction} {course}"
            if (direction, course) in free:
                if any(noticed):
                    yield f"{what}: listed as free, and noticed"
            elif not any(noticed):
                yield f"{what}: not noticed"
            elif sorted(noticed) != noticed and (case, direction) not in COMES_BACK:
                yield f"{what}: a larger one is not noticed"


def survivors(case):
    """Predicate, signal and mutation of every mutant that still passes; how many were tried."""
    spec, run, step_id = NAMED[case]
    before = answer(run, spec, step_id)
    assert before.status == "passed", before
    start = start_of(run, step_id)
    found, tried = [], 0
    if isinstance(spec, DurationCheck | FractionCheck) or getattr(spec, "stalled", None):
        for kind, mutant in reported(run, spec):
            tried += 1
            if answer(mutant, spec, step_id).status == "passed":
                found.append(f"{name_of(spec)} / steps / {kind}")
        return found, tried
    for place in read_by(run, spec, step_id):
        shown_only = (name_of(spec), place[0]) in SHOWN_ONLY
        found += unnoticed_shifts(case, place)
        for kind, mutate in MUTATIONS.items():
            if (name_of(spec), place[0], kind) in SAME_THING or (shown_only and kind in IN_DOUBT):
                continue
            answers = [answer(mutant, spec, step_id) for mutant in mutate(run, place, start)]
            tried += bool(answers)
            noticed = [
                after.status != "passed"
                or (shown_only and (after.margin, after.unit) != (before.margin, before.unit))
                for after in answers
            ]
            if answers and not any(noticed):
                found.append(f"{name_of(spec)} / {place[0]} {place[1] or ''} / {kind}")
    return found, tried


@pytest.mark.parametrize("kind", SUBJECTS)
def test_no_corrupted_picture_goes_on_passing(kind):
    spec, run, step_id = seen_run(kind)
    assert answer(run, spec, step_id).status == "passed"
    survived = [
        number
        for number, (_, mutant) in enumerate(corrupted(run, spec))
        if answer(mutant, spec, step_id).status == "passed"
    ]
    assert survived == []


@pytest.mark.nightly(
    only=[
        "until",
        "lifted",
        "placed",
        "in",
        "grasped",
        "slip",
        "formula",
        "formula 3",
        "joint 2",
        "inserted",
        "joint",
        "static 2",
    ]
)
@pytest.mark.parametrize("case", NAMED)
def test_no_corrupted_signal_goes_on_passing(case):
    found, tried = survivors(case)
    assert tried >= 2
    assert not found, "still passes; see `Free` in evidence.py:\n" + "\n".join(found)


@pytest.mark.parametrize(("case", "place", "direction"), MEASURED)
def test_a_shift_is_noticed_just_past_the_margin_and_not_before(case, place, direction):
    spec, run, step_id = NAMED[case]
    margin = answer(run, spec, step_id).margin
    for way in direction.removesuffix(direction.lstrip("+-")):
        sizes = (0.999 * margin, 1.001 * margin)
        start = start_of(run, step_id)
        mutants = shifted(run, place, start, way + direction.lstrip("+-"), AT_ONCE, sizes)
        statuses = [answer(mutant, spec, step_id).status for mutant in mutants]
        assert statuses == ["passed", "failed"]


def test_every_free_shift_names_a_case_and_a_signal_that_it_reads():
    for free in FREE:
        for case in free.cases.split(", "):
            spec, run, step_id = NAMED[case]
            read = read_by(run, spec, step_id)
            for signal in free.signals.split(", "):
                field, _, key = signal.partition(" ")
                keyed = [place for place in read if place[0] == field and key in str(place[1])]
                assert keyed, (case, signal)


def test_every_predicate_has_a_case():
    judged = set(PREDICATES.values())
    named = {type(getattr(spec, "predicate", spec)) for spec, _, _ in CASES} | {Lifted}
    named |= {type(seen_run(kind)[0]) for kind in SUBJECTS}
    assert judged <= named


def test_every_signal_of_a_run_is_read_by_some_predicate():
    read = {field for spec, run, step_id in CASES for field, _ in read_by(run, spec, step_id)}
    recorded = {entry.name for entry in fields(Signals)} - {"clearance_cutoff", "times"}
    for_people = {"clearance_links"}  # which link it was
    of_held = {"slides"}  # of what is held alone; `test_excused_force` corrupts it
    of_cups = {"pulls"}  # of what suction holds; `test_suction` lets cups leak
    of_belts = {"surfaces"}  # of surfaces that move; `test_conveyor` reads their velocity
    assert recorded - read == for_people | of_held | of_cups | of_belts


def test_a_predicate_that_ignores_a_signal_would_be_found():
    """The check itself can fail: a signal read and not used survives."""
    run = lift_run()
    spec = Lifted(object="box", above=0.05)
    blind = replace(run, signals=replace(run.signals))
    place = ("joint_positions", None)
    assert place not in read_by(blind, spec, "lift")
    assert all(
        answer(mutant, spec, "lift").status == "passed" for mutant in frozen(run, place, 140)
    )
