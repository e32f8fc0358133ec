"""Every signal that a predicate reads, spoilt in every way: no verdict may go on passing.

Nothing here is picked by hand but one passing run for each predicate, with a time before its window
in which the predicate did not hold. What a predicate reads is traced while it is judged; each of
those signals is then shifted, frozen, dropped and made NaN:

- shift: from the window's start on, by each of `SHIFTS` either way, at once or as a drift of so
  much a second, in each column (quaternions stay of unit length); at least one must be noticed;
- freeze: it keeps its value from some moment on; at least one moment must be noticed, which is one
  at which the predicate did not hold;
- drop: it was not recorded, and neither was its kind, where a missing key means "never touched";
- NaN: none of its samples is known.

A mutant that equals the original is none, and `SAME_THING` lists those that are what the predicate
speaks of: nobody can tell a stuck signal from a thing that stands still. `SHOWN_ONLY` lists what
moves a margin and decides nothing, with the reason; there a mutant is noticed when the margin is
another one.
"""

from dataclasses import fields, replace
from typing import get_args

import numpy as np
import pytest

from harness.assertions.judge import EXECUTED, judge
from harness.assertions.placed import PlacedExpectation
from harness.core.spatial import SE3
from harness.recording.run import Signals
from harness.spec.checks import (
    AnyPredicate,
    Clearance,
    Collision,
    Displaced,
    DurationCheck,
    Effort,
    Formula,
    FractionCheck,
    Grasped,
    GripperState,
    In,
    InContact,
    Joints,
    Lifted,
    NamedTarget,
    Never,
    On,
    PathLength,
    Placed,
    Released,
    Slip,
    Static,
    TcpPath,
    TcpPose,
    TrackingError,
    Until,
    Upright,
    WithinLimits,
)
from harness.spec.poses import Pose
from tests.assertions.picture_mutants import SUBJECTS, seen_run, spoilt
from tests.assertions.synthetic_run import (
    BOX,
    ROBOT,
    TABLE,
    at,
    attachment,
    force,
    heights,
    lift_run,
    make_run,
    step,
    thing,
)

pytestmark = pytest.mark.mutation
N = 200
SHIFTS = (0.02, 0.3, 3.0, 30.0)
MOMENTS = range(0, N, 10)
FORCES_AND_DISTANCES = (
    *("contact_forces", "presses", "support_forces"),
    *("clearances", "planned_clearances"),
)
MAPPINGS = ("frames", "object_poses", *FORCES_AND_DISTANCES)
SHOWN_ONLY = {
    ("collision", "clearances"): "contacts decide; how near it came is the margin of what did not"
}
SAME_THING = {
    (
        "static",
        "object_poses",
        "freeze",
    ): "a pose that does not change is a thing that stands still",
    ("within_limits", "joint_command_velocities", "freeze"): "a velocity that does not change is no"
    " acceleration",
}
LATE = (step("early", 0, 100), step("late", 100, N))


def columns(shoulder, finger=0.0):
    """Two joints, each a number before the window and one in it."""
    rows = np.zeros((N, 2))
    for column, value in enumerate((shoulder, finger)):
        before, inside = value if isinstance(value, tuple) else (value, value)
        rows[:100, column], rows[100:, column] = before, inside
    return rows


def late(**signals):
    return make_run(steps=LATE, **signals)


def halves(before, inside):
    """A pose before the window and one in it, each xyz and roll."""
    poses = [at(100, p[:3], SE3.from_xyz_rpy(rpy=(p[3], 0, 0)).quat_wxyz) for p in (before, inside)]
    return np.concatenate(poses)


def standing(**more):
    """The box in the hand, elsewhere and tilted, then put down on the table."""
    forces = {
        ("Table", "box"): force(N, (90, N)),
        ("left_finger", "box"): force(N, (20, 80)),
        ("right_finger", "box"): force(N, (20, 80)),
    }
    box = halves((0.3, 0, -0.3, 1.0), (0, 0, 0.02, 0))
    carried = {("Table", "box"): forces["Table", "box"]}
    return late(contact_forces=forces, support_forces=carried, object_poses={"box": box}, **more)


BIN = thing("bin", static=True)
IN_BIN = late(
    objects=(TABLE, BOX, BIN),
    object_poses={
        "box": halves((0.2, 0, 0.02, 0), (0, 0, 0.02, 0)),
        "bin": halves((0, 0.2, 0.02, 0), (0, 0, 0.02, 0)),
    },
)
LINE = {"start": {"xyz": [0, 0, 0.3]}, "end": {"xyz": [0, 0, 0.5]}}
ALONG = heights(np.concatenate([np.full(100, 0.3), np.linspace(0.3, 0.5, 100)]))
SWING = at(N, (0, 0, 0.02))
SWING[:100, 0] = np.linspace(-0.1, 0, 100)
DISTANT = np.where(np.arange(N) < 100, 0.001, 0.05)
MOVING = {
    "joint_positions": columns((0.9, 0.0), 0.02),
    "joint_velocities": columns((1.0, 0.0), (0.3, 0.0)),
    "joint_efforts": columns((11.0, 1.0), (21.0, 1.0)),
    "joint_commands": columns((0.0, 0.0), 0.02),
    "joint_command_velocities": np.where(np.arange(N)[:, None] < 100, np.arange(N)[:, None], 99.0)
    * np.array([1.0, 0.0]),
}
REPORTS = (
    step("path", 0, 100, "cartesian_path", result={"fraction": 0.9}),
    step("late", 100, N, "gripper", result={"stalled": True}),
)

CASES = [
    (Lifted(object="box", above=0.05), lift_run(), "lift"),
    (Grasped(object="box"), lift_run(), ""),
    (Released(object="box"), standing(), "late"),
    (Placed(object="box", on="Table", pose=Pose(xyz=(0, 0, 0.02))), standing(), "late"),
    (On(object="box", support="Table"), standing(), "late"),
    (In(object="box", container="bin"), IN_BIN, "late"),
    (
        Displaced(object="box", at_least=0.05),
        late(object_poses={"box": halves((0.3, 0, 0.02, 0), (0, 0, 0.02, 0))}),
        "late",
    ),
    (Upright(object="box"), standing(), "late"),
    (Static(object="box"), late(object_poses={"box": SWING}), "late"),
    (Static(), late(object_poses={"box": SWING}, joint_velocities=columns((1, 0), (1, 0))), "late"),
    (InContact(between=("left_finger", "box"), min_force=0.5), lift_run(), "lift"),
    (
        Never(predicate=Collision(between=("robot", "box"))),
        late(
            contact_forces={("arm_link", "box"): force(N, (20, 60))},
            clearances={("robot", "box"): DISTANT},
        ),
        "late",
    ),
    (Never(predicate=Collision()), late(clearances={("robot", "box"): DISTANT}), "late"),
    (
        Clearance(between=("robot", "box"), at_least=0.01),
        late(clearances={("robot", "box"): DISTANT}),
        "late",
    ),
    (
        Clearance(between=("robot", "box"), max_below_plan=0.01),
        late(
            clearances={("robot", "box"): DISTANT},
            planned_clearances={("robot", "box"): np.full(N, 0.055)},
        ),
        "late",
    ),
    (
        TcpPose(pose=Pose(xyz=(0, 0, 0.3), frame="box")),
        late(
            tcp_pose=halves((0, 0.1, 0.3, 0.5), (0, 0, 0.32, 0)),
            object_poses={"box": halves((0.1, 0, 0, 0), (0, 0, 0.02, 0))},
        ),
        "late",
    ),
    (
        TcpPose(link="arm_link", pose=Pose(xyz=(0, 0, 0.3))),
        late(frames={"arm_link": halves((0, 0.1, 0.3, 0.5), (0, 0, 0.3, 0))}),
        "late",
    ),
    (TcpPath(line=LINE), late(tcp_pose=ALONG), "late"),
    (PathLength(at_most=0.21, at_least=0.19), late(tcp_pose=ALONG), "late"),
    (Joints(positions={"shoulder": 0.0, "finger": 0.02}), late(**MOVING), "late"),
    (NamedTarget(state="home"), late(**MOVING), "late"),
    (GripperState(position=0.02), late(joint_positions=columns(0, (0, 0.02))), "late"),
    (GripperState(width=0.04), late(joint_positions=columns(0, (0, 0.02))), "late"),
    (GripperState(stalled=True), make_run(steps=REPORTS), "late"),
    (
        WithinLimits(acceleration=True),
        late(
            **{
                **MOVING,
                "joint_positions": columns((2.0, 0.0), (0.5, 0.02)),
                "joint_velocities": columns((3.0, 0.0), (2.0, 0.0)),
            }
        ),
        "late",
    ),
    (
        WithinLimits(velocity=False, effort=False),
        replace(
            late(joint_positions=columns((2.0, 0.0), -0.0005), joint_commands=columns(0.0)),
            robot=replace(ROBOT, gripper=None),
        ),
        "late",
    ),
    (TrackingError(), late(**MOVING), "late"),
    (Effort(max_fraction=0.5), late(**MOVING), "late"),
    (DurationCheck(at_most=1.0, at_least=0.9), late(), "late"),
    (FractionCheck(at_least=0.8), make_run(steps=REPORTS), ""),
    (
        Slip(object="box"),
        lift_run(attachments=[attachment("box", 45, N)]),
        "",
    ),
    (
        Formula(
            formula="always (z(box) < 0.1 and force(Table, box) > 0.5 and tilt(box) < 0.1"
            ") and eventually z(tcp) > 0.49"
        ),
        standing(tcp_pose=ALONG),
        "late",
    ),
    (
        Formula(formula="eventually (speed(box) > 0.05 and speed(box) < 1)"),
        late(object_poses={"box": SWING}),
        "",
    ),
    (
        Formula(
            formula="always (abs(position(shoulder) - command(shoulder)) < 0.05"
            " and velocity(shoulder) < 0.1 and effort(shoulder) < 2"
            " and distance(robot, box) > 0.01)"
        ),
        late(**MOVING, clearances={("robot", "box"): DISTANT}),
        "late",
    ),
    (
        Until(predicate=On(object="box", support="Table"), until=Lifted(object="box", above=0.05)),
        lift_run(leave=140, object_poses={"box": heights([0.02] * 140 + [0.12] * 60)}),
        "",
    ),
]


def name_of(spec):
    inner = getattr(spec, "predicate", spec)
    return inner.check


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


def array_of(signals, place):
    field, key = place
    return getattr(signals, field) if key is None else getattr(signals, field)[key]


def with_array(run, place, array):
    field, key = place
    value = array if key is None else {**getattr(run.signals, field), key: array}
    return replace(run, signals=replace(run.signals, **{field: value}))


def shifted(run, place, start):
    array = array_of(run.signals, place)
    drift = np.arange(len(array) - start) * (run.signals.times[1] - run.signals.times[0])
    for column in range(1 if array.ndim == 1 else array.shape[1]):
        for size in (sign * size for size in SHIFTS for sign in (1, -1)):
            for course in (1.0, drift):
                moved = array.copy().reshape(len(array), -1)
                moved[start:, column] += size * course
                if moved.shape[1] == 7:
                    moved[:, 3:] /= np.linalg.norm(moved[:, 3:], axis=1, keepdims=True)
                yield with_array(run, place, moved.reshape(array.shape))


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


MUTATIONS = {"shift": shifted, "freeze": frozen, "drop": dropped, "NaN": unknown}


def reported(run, spec):
    """Mutants of what steps report, and of how long they took."""
    for kind, change in (
        ("shift", lambda value: not value if isinstance(value, bool) else value - 0.5),
        ("drop", None),
        ("NaN", lambda _: float("nan")),
    ):
        steps = [
            replace(
                each,
                end_time=each.end_time if kind != "shift" else each.end_time + 0.5,
                result={key: change(value) for key, value in each.result.items()} if change else {},
            )
            for each in run.steps
        ]
        if kind == "drop" and isinstance(spec, DurationCheck):
            steps = []
        if kind == "NaN":
            steps = [replace(each, end_time=float("nan")) for each in steps]
        yield kind, replace(run, steps=tuple(steps))


def survivors(spec, run, step_id):
    """Predicate, signal and mutation of every mutant that still passes."""
    before = answer(run, spec, step_id)
    assert before.status == "passed", before
    window = next((s for s in run.steps if s.id == step_id), None)
    start = window.start_index if window else 0
    found, tried = [], 0
    if isinstance(spec, DurationCheck | FractionCheck) or getattr(spec, "stalled", None):
        for kind, mutant in reported(run, spec):
            tried += 1
            if answer(mutant, spec, step_id).status == "passed":
                found.append(f"{name_of(spec)} / steps / {kind}")
        return found, tried
    for place in read_by(run, spec, step_id):
        shown_only = (name_of(spec), place[0]) in SHOWN_ONLY
        for kind, mutate in MUTATIONS.items():
            if (name_of(spec), place[0], kind) in SAME_THING:
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
def test_no_spoilt_picture_goes_on_passing(kind):
    spec, run, step_id = seen_run(kind)
    assert answer(run, spec, step_id).status == "passed"
    survived = [
        number
        for number, (_, mutant) in enumerate(spoilt(run, spec))
        if answer(mutant, spec, step_id).status == "passed"
    ]
    assert survived == []


@pytest.mark.parametrize(("spec", "run", "step_id"), CASES, ids=[name_of(c[0]) for c in CASES])
def test_no_spoilt_signal_goes_on_passing(spec, run, step_id):
    found, tried = survivors(spec, run, step_id)
    assert tried >= 3
    assert not found


def test_every_predicate_has_a_case():
    judged = set(get_args(AnyPredicate)) & EXECUTED
    named = {type(getattr(spec, "predicate", spec)) for spec, _, _ in CASES} | {Lifted}
    named |= {type(seen_run(kind)[0]) for kind in SUBJECTS}
    assert judged <= named


def test_every_signal_of_a_run_is_read_by_some_predicate():
    read = {field for spec, run, step_id in CASES for field, _ in read_by(run, spec, step_id)}
    recorded = {entry.name for entry in fields(Signals)} - {"clearance_cutoff", "times"}
    for_people = {"clearance_links"}  # which link it was
    assert recorded - read == for_people


def test_a_predicate_that_ignores_a_signal_would_be_found():
    """The check itself can fail: a signal read and not used survives."""
    run = lift_run()
    spec = Lifted(object="box", above=0.05)
    blind = replace(run, signals=replace(run.signals))
    place = ("tcp_pose", None)
    assert place not in read_by(blind, spec, "lift")
    assert all(
        answer(mutant, spec, "lift").status == "passed" for mutant in frozen(run, place, 140)
    )
