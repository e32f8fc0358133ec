"""Signal temporal logic: the text, its places, and its values against a brute-force evaluator."""

import math

import numpy as np
import pytest
from hypothesis import strategies as st

from harness.judging.temporal import TooShort, always, eventually, never
from harness.judging.window import NotObservable, NotReached, Window
from harness.plugins.formulas.expectations.formula import Formula
from harness.plugins.formulas.expectations.until import until_decision
from harness.plugins.formulas.language.formula import (
    Comparison,
    Const,
    Interval,
    Logic,
    Signal,
    Temporal,
    parts_of,
)
from harness.plugins.formulas.language.parser import parse_formula
from harness.plugins.formulas.language.ranges import decided_parts
from harness.plugins.formulas.language.text import FormulaError
from harness.plugins.formulas.verdict import TINY, Evaluation, formula_verdict
from tests.judging import evidence_runs as shared
from tests.judging.evidence import AT_ONCE, Evidence, Free
from tests.judging.synthetic_run import at, force, heights, lift_run, make_run, verdict
from tests.lanes import property_test
from tests.session.front_door import problems

EPS = 1e-9


def window_of(run):
    return Window(run, 0, len(run.signals.times))


def run_of(a, b, times):
    """A run in which `x(tcp)` is one signal and `y(tcp)` another."""
    tcp = at(len(times))
    tcp[:, 0], tcp[:, 1] = a, b
    return make_run(len(times), times=np.asarray(times, dtype=float), tcp_pose=tcp)


@st.composite
def signals(draw):
    """Two margins, and rising times on a grid of 10 ms with gaps."""
    n = draw(st.integers(1, 25))
    column = st.lists(st.integers(-3, 3), min_size=n, max_size=n)
    gaps = draw(st.lists(st.integers(1, 4), min_size=n, max_size=n))
    return np.array(draw(column), float), np.array(draw(column), float), np.cumsum(gaps) * 0.01


spans = st.integers(0, 40).map(lambda ticks: ticks * 0.01)
intervals = st.tuples(spans, spans).map(lambda ends: Interval(min(ends), max(ends)))
intervals = intervals | st.just(Interval()) | spans.map(lambda first: Interval(first, math.inf))


def _grow(inner):
    two = st.tuples(inner, inner)
    return st.one_of(
        inner.map(lambda a: Logic("not", (a,), 0)),
        st.tuples(st.sampled_from(["and", "or", "implies"]), two).map(
            lambda t: Logic(t[0], t[1], 0)
        ),
        st.tuples(st.sampled_from(["always", "eventually"]), inner, intervals).map(
            lambda t: Temporal(t[0], (t[1],), t[2], 0)
        ),
        st.tuples(two, intervals).map(lambda t: Temporal("until", t[0], t[1], 0)),
    )


atoms = st.tuples(
    st.sampled_from(["x", "y"]), st.sampled_from(["<", "<=", ">", ">="]), st.integers(-2, 2)
).map(lambda t: Comparison(Signal(t[0], ("tcp",), (0,), 0), t[1], Const(t[2], "", 0), 0, "a"))
formulas = st.recursive(atoms, _grow, max_leaves=6)


def brute(node, i, columns, times, side):
    """The least (side -1) or largest (side 1) margin at a sample, by the definitions alone."""
    if isinstance(node, Comparison):
        value = columns[node.left.name][i] - node.right.value
        value = value if node.operator[0] == ">" else -value
        return value or (TINY if "=" in node.operator else -TINY)
    if isinstance(node, Logic):
        first = node.operands[0]
        if node.operator == "not":
            return -brute(first, i, columns, times, -side)
        second = brute(node.operands[1], i, columns, times, side)
        if node.operator == "and":
            return min(brute(first, i, columns, times, side), second)
        if node.operator == "or":
            return max(brute(first, i, columns, times, side), second)
        return max(-brute(first, i, columns, times, -side), second)
    begin, end = times[i] + node.interval.first, times[i] + node.interval.last
    n, is_bounded = len(times), not math.isinf(node.interval.last)
    beyond = is_bounded and end > times[-1] + EPS
    inside = [j for j in range(n) if begin - EPS <= times[j] <= end + EPS]
    if node.operator == "always":
        late = [j for j in range(n) if times[j] >= end - EPS]
        if late and times[late[0]] >= begin - EPS and is_bounded:
            inside = sorted({*inside, late[0]})
        if not inside:
            return side * math.inf
        held = min(brute(node.operands[0], j, columns, times, side) for j in inside)
        return -math.inf if beyond and side < 0 else held
    if node.operator == "eventually":
        if not inside:
            return side * math.inf
        best = max(brute(node.operands[0], j, columns, times, side) for j in inside)
        return math.inf if beyond and side > 0 else best
    held = [brute(node.operands[0], k, columns, times, side) for k in range(i, n)]
    options = [
        min([brute(node.operands[1], j, columns, times, side), *held[: j - i]]) for j in inside
    ]
    if not inside and not beyond:
        if not is_bounded:
            return min([*held, side * math.inf])
        before = [held[k - i] for k in range(i, n) if times[k] < begin - EPS]
        return min([*before, side * math.inf])
    if beyond and side > 0:
        options.append(min(held))
    return max(options, default=-math.inf)


@property_test(signals(), formulas, few=50, many=400)
def test_a_formula_is_worth_what_its_definition_says(signal, formula):
    x, y, times = signal
    window = window_of(run_of(x, y, times))
    bounds = Evaluation(window).bounds(formula)
    columns = {"x": x, "y": y}
    for i in range(len(times)):
        assert bounds.low[i] == brute(formula, i, columns, times, -1), "at least"
        assert bounds.high[i] == brute(formula, i, columns, times, 1), "at most"


@property_test(signals(), formulas, few=50, many=400)
def test_what_decides_a_formula_is_a_sample_with_its_margin(signal, formula):
    x, y, times = signal
    evaluation = Evaluation(window_of(run_of(x, y, times)))
    bounds = evaluation.bounds(formula)
    for holds in (True, False):
        value = (bounds.low if holds else bounds.high)[0]
        if math.isfinite(value):
            node, index, sign = evaluation.decider(formula, 0, at_least=holds)
            difference = {"x": x, "y": y}[node.left.name][index] - node.right.value
            margin = difference if node.operator.startswith(">") else -difference
            assert sign * margin == pytest.approx(value)


def test_how_many_samples_are_known_is_counted_over_all_signals():
    x = np.array([1.0, np.nan, np.nan, 0.0, 2.0])
    y = np.array([1.0, 1.0, np.nan, np.nan, 1.0])
    run = run_of(x, y, np.arange(5) * 0.1)
    text = "eventually (x(tcp) > 1.5 and y(tcp) > 0.5)"
    answer = verdict(run, Formula(formula=text))
    assert (answer.observed.samples, answer.observed.unknown) == (2, 3)
    answer = verdict(run, Formula(formula="x(tcp) > 0.5 implies time >= 0"))
    assert answer.observed.premises == 4, "where it is not known it may hold"


def test_an_infinite_number_is_not_known():
    run = run_of(np.array([np.inf, 1.0]), np.zeros(2), np.arange(2) * 0.1)
    answer = verdict(run, Formula(formula="always x(tcp) > 0"))
    assert answer.status == "not observable"


FAR = {("robot", "box"): np.full(200, 0.15), ("robot", "Table"): np.full(200, 0.15)}
NEAR = {("robot", "box"): np.full(200, 0.149), ("robot", "Table"): np.full(200, 0.15)}


@pytest.mark.parametrize(
    ("text", "near", "far"),
    [
        ("distance(robot, box) > 0.1", "passed", "passed"),
        ("distance(robot, box) < 0.1", "failed", "failed"),
        ("distance(robot, box) < 0.2", "passed", "not observable"),
        ("distance(robot, box) > 0.2", "failed", "not observable"),
        ("0.2 < distance(robot, box)", "failed", "not observable"),
        ("distance(robot, box) <= 0.15", "passed", "not observable"),
        ("distance(robot, box) >= 0.15", "failed", "passed"),
        ("not distance(robot, box) < 0.2", "failed", "not observable"),
        ("always[0, 1] distance(robot, box) > 0.2", "failed", "not observable"),
        ("distance(robot, box) * 2 < 0.4", "passed", "not observable"),
        ("1 / distance(robot, box) > 5", "passed", "not observable"),
        ("1 / distance(robot, box) < 8", "passed", "passed"),
        ("distance(robot, box) < distance(robot, Table)", "passed", "not observable"),
        ("distance(robot, box) - distance(robot, Table) < 1", "passed", "not observable"),
        ("min(distance(robot, box), 0.1) < 0.12", "passed", "passed"),
        ("always[0, 5] distance(robot, box) > 0.1", "not reached", "not reached"),
        ("distance(robot, box) < 0.2 or time >= 0", "passed", "passed"),
    ],
)
def test_a_distance_at_the_cutoff_is_at_least_as_much(text, near, far):
    for clearances, status in ((NEAR, near), (FAR, far)):
        run = make_run(clearances=clearances, clearance_cutoff=0.15)
        answer = verdict(run, Formula(formula=text))
        assert answer.status == status, text
        if status == "not observable":
            assert answer.reason == "distances were recorded up to 150 mm only"


@pytest.mark.parametrize(
    ("text", "is_refused"),
    [
        ("position(joint1) < 9.4", False),
        ("position(joint1) < 9.5", True),
        ("-9.5 < command(joint1)", True),
        ("abs(position(joint1)) < 9.4", False),
        ("abs(position(joint1)) < 90", True),
        ("2 * position(joint1) < 90", True),
        ("position(joint1) - position(joint2) < 9.5", False),
        ("position(joint1) - 10 > 0", True),
        ("max(velocity(joint1), velocity(joint2)) < 360", True),
        ("velocity(joint1) < 14.3", False),
        ("velocity(joint1) > -14.5", True),
        ("effort(joint1) < 1e9", True),
        ("time < 90 and z(tcp) < 90 and position(joint1) < position(joint2)", False),
        ("always (time > 1 implies eventually[0, 1] position(joint1) > 90)", True),
    ],
)
def test_a_number_far_beyond_a_joints_limits_is_in_another_unit(tmp_path, text, is_refused):
    """Joint 1 turns by pi either way, and by 4.8 rad/s; the numbers are three times as large."""
    found = problems(
        tmp_path, "- wait: 1 s", robot="open_manipulator_x", rest=f"expect: [formula: '{text}']"
    )
    assert len(found) == is_refused, found


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("always 0.4 > 0.3", "reads no signal"),
        ("always z(tcp) > 0.1 and 2 * 3 m > 1 m", "reads no signal"),
        ("force(robot, robot) >= 0", "always holds"),
        ("always not speed(tcp) < 0", "never holds"),
        ("-speed(tcp) <= 0", "always holds"),
        ("abs(z(tcp)) + 1 m > 0.5", "always holds"),
        ("0 * z(tcp) > 1", "never holds"),
        ("max(force(robot, robot), 2) > min(1, force(robot, robot))", "always holds"),
        ("1 / (1 + force(robot, robot)) <= 1", "always holds"),
        ("effort(joint1) <= 5", "always holds"),
        ("-time > 0", "never holds"),
        ("z(tcp) < z(tcp) + 1 m", "always holds"),
        ("always 1 m + x(tcp) - (z(tcp) + x(tcp)) > 2 m - z(tcp)", "never holds"),
        ("abs(y(tcp)) - z(tcp) >= abs(y(tcp)) - z(tcp)", "always holds"),
        ("z(tcp) * z(tcp) >= 0", "always holds"),
        ("(z(tcp) - 1 m) * (z(tcp) - 1 m) + 2 * (x(tcp) * x(tcp)) < 0", "never holds"),
        ("abs(z(tcp) * z(tcp)) + 1 > 0.5", "always holds"),
        ("always (z(tcp) > 1 m or z(tcp) <= 1 m)", "(z(tcp) > 1 m or z(tcp) <= 1 m)` always holds"),
        ("eventually (z(tcp) > 1 m and 0.5 m > z(tcp))", "never holds"),
        ("always (z(tcp) > 10 cm implies 2 * z(tcp) + x(tcp) > 20 cm + x(tcp))", "always holds"),
        ("not (z(tcp) - x(tcp) < 1 m and x(tcp) - z(tcp) < -1 m)", "never holds"),
        ("x(tcp) < 1 m and (time < 1 or time / 2 >= 0.5)", "(time < 1 or time / 2 >= 0.5)` always"),
        ("always distance(robot, robot) >= -100 m", "always holds"),
        ("always speed(tcp) < 1e9", "always holds"),
        ("always z(tcp) + x(tcp) > -1e9", "always holds"),
        ("always z(tcp) > -1000 m and speed(tcp) < 1000", ""),
        ("z(tcp) > 1 m or z(tcp) < 1 m", ""),
        ("z(tcp) > 1 m or x(tcp) <= 1 m", ""),
        ("z(tcp) > 1 m or always z(tcp) <= 1 m", ""),
        ("z(tcp) > 1 m and z(tcp) > 2 m", ""),
        ("z(tcp) - x(tcp) < 1 m or x(tcp) - z(tcp) < 1 m", "always holds"),
        ("z(tcp) - x(tcp) < 1 m or z(tcp) > 1 m", ""),
        ("distance(robot, ground_plane) >= -1 mm", ""),
        ("z(tcp) * x(tcp) >= 0", ""),
        ("z(tcp) * z(tcp) > 0", ""),
        ("z(tcp) - x(tcp) < 1 m", ""),
        ("z(tcp) + z(tcp) > z(tcp) + 1 m", ""),
        ("force(robot, robot) > 0", ""),
        ("force(robot, robot) <= 0", ""),
        ("tilt(tcp) < 3.14", ""),
        ("z(tcp) / speed(tcp) > -1", ""),
        ("2 - speed(tcp) > 1", ""),
    ],
)
def test_a_comparison_that_no_run_decides_is_refused(tmp_path, text, reason):
    found = problems(
        tmp_path, "- wait: 1 s", robot="open_manipulator_x", rest=f"expect: [formula: '{text}']"
    )
    assert [reason in message for _, message in found] == ([True] if reason else []), found


comparisons = st.builds(
    "{0} * {1}(tcp) {2} {3}".format,
    *map(st.sampled_from, ((-2, -1, 1), "xy", ("<", "<=", ">", ">="), (-1, 0, 1))),
)
logic = st.recursive(
    comparisons,
    lambda inner: (
        st.builds("({0}) {1} ({2})".format, inner, st.sampled_from(("and", "or", "implies")), inner)
        | st.builds("not ({})".format, inner)
    ),
    max_leaves=5,
)


@property_test(logic, few=60, many=2000)
def test_a_formula_is_decided_where_no_value_of_its_signals_matters(text):
    """The numbers are compared with -1 to 1, so that quarters from -2 to 2 are all the cases."""
    values = np.arange(-2, 2.1, 0.25)
    xs, ys = (each.ravel() for each in np.meshgrid(values, values))
    times = np.arange(len(xs)) * 0.1
    evaluation = Evaluation(window_of(run_of(xs, ys, times)))
    constant = [
        part
        for part in parts_of(parse_formula(text))
        if isinstance(part, Comparison | Logic) and len(set(evaluation.bounds(part).low > 0)) == 1
    ]
    found = [part for part, _ in decided_parts(parse_formula(text))]
    smallest = [each for each in constant if not set(parts_of(each)) & {*constant} - {each}]
    assert found == smallest, text
    for part, holds in decided_parts(parse_formula(text)):
        assert (evaluation.bounds(part).low[0] > 0) == holds


def test_a_formula_of_numbers_alone_observes_nothing():
    run = run_of(np.zeros(3), np.zeros(3), np.arange(3.0))
    with pytest.raises(NotObservable, match="reads no signal"):
        formula_verdict("always 2 > 1", window_of(run))


def _said(text, x, y, times):
    try:
        return formula_verdict(text, window_of(run_of(x, y, times))).status
    except NotReached:
        return "not reached"


def _word(function, *arguments):
    try:
        decision = function(*arguments)
    except TooShort:
        return None
    decision = decision[0] if isinstance(decision, tuple) else decision
    return "passed" if decision.holds else "failed"


optional = st.none() | spans


@property_test(signals(), optional, optional, few=25, many=200)
def test_temporal_words_agree_with_their_formulas(signal, hold, within):
    """Where a formula is not decided, because a hold or deadline ends too late, a word may fail."""
    x, y, times = signal
    held = "{}" if hold is None else f"always[0, {hold:.2f}] {{}}"
    by = "" if within is None else f"[0, {within:.2f}]"
    came = held.format("y(tcp) >= 0")
    pairs = [
        (f"eventually{by} ({came})", _word(eventually, y, times, hold, within)),
        (f"not eventually{by} ({came})", _word(never, y, times, hold, within)),
        (f"x(tcp) >= 0 until{by} ({came})", _word(until_decision, x, y, times, hold, within)),
    ]
    if hold is None and within is not None:
        pairs.append((f"eventually{by} always y(tcp) >= 0", _word(always, y, times, None, within)))
    if hold is None and within is None:
        pairs.append(("always y(tcp) >= 0", _word(always, y, times)))
    for text, answer in pairs:
        said = _said(text, x, y, times)
        if said == "not reached":
            assert hold is not None or within is not None, text
            continue
        if answer is None:  # no room for the hold: a formula can still be known not to hold
            assert hold is not None
            assert said == ("passed" if text.startswith("not") else "failed"), text
            continue
        assert said == answer, text


@pytest.mark.parametrize(
    ("text", "is_warned"),
    [
        ("z(box) < 10 cm", True),
        ("not z(box) > 10 cm and time < 1", True),
        ("always[0, 0] z(box) < 10 cm", True),
        ("always z(box) < 10 m", False),
        ("time < 1 and eventually z(box) > 10 cm", False),
        ("z(box) < 10 m until z(box) > 10 cm", False),
    ],
)
def test_a_formula_that_reads_its_first_sample_alone_has_a_warning(text, is_warned):
    answer = verdict(lift_run(), Formula(formula=text))
    assert answer.status == "passed"
    assert [each.name for each in answer.warnings] == ["hardly observed"] * is_warned


def test_during_is_the_formula_on_the_step_s_samples():
    run = lift_run()
    for step, status in (("approach", "failed"), ("lift", "passed")):
        spec = Formula(formula="eventually z(box) > 10 cm", during=step)
        assert verdict(run, spec).status == status
        assert verdict(run, Formula(formula="eventually z(box) > 10 cm"), step).status == status


def test_a_formula_reports_margin_unit_sample_and_numbers():
    answer = verdict(lift_run(), Formula(formula="eventually z(box) > 7 cm"))
    assert (answer.status, answer.unit) == ("passed", "m")
    assert answer.margin == pytest.approx(0.05)
    assert answer.time == pytest.approx(1.5)
    assert answer.reason == "z(box) > 7 cm holds: 120 mm against 70.0 mm at t=1.500 s"
    barely = verdict(lift_run(), Formula(formula="eventually z(box) > 121 mm"))
    assert barely.status == "failed"
    assert barely.margin == pytest.approx(-0.001)
    never = verdict(lift_run(), Formula(formula="not eventually force(Table, box) > 2 N"))
    assert (never.status, never.unit, never.margin) == ("passed", "N", pytest.approx(1.0))


@pytest.mark.parametrize(
    ("text", "status", "said", "name", "comparison"),
    [
        ("always z(box) < 5 cm", "failed", "does not hold: 120 mm against 50.0", "z(box)", "<="),
        ("eventually z(box) > 7 cm", "passed", "holds: 120 mm against 70.0", "z(box)", ">="),
        ("not eventually z(box) > 7 cm", "failed", "holds: 120 mm", "z(box)", "<="),
        ("not always z(box) > 7 cm", "passed", "does not hold: 20.0 mm", "z(box)", "<="),
        ("always 10 cm > z(box)", "failed", "does not hold: 100 mm against 120", "10 cm > z(box)",
         ">="),
        ("z(box) >= 2 cm", "passed", "holds: 20.0 mm against 20.0", "z(box)", ">="),
        ("z(box) > 2 cm", "failed", "does not hold: 20.0 mm against 20.0", "z(box)", ">="),
        ("always (z(box) > 7 cm implies force(Table, box) < 1 N)", "passed",
         "does not hold: 20.0 mm", "z(box)", "<="),
    ],
)  # fmt: skip
def test_a_verdict_says_which_way_the_deciding_comparison_went(
    text, status, said, name, comparison
):
    answer = verdict(lift_run(), Formula(formula=text))
    measure = answer.measures[0]
    assert answer.status == status
    assert said in answer.reason
    assert (measure.name, measure.comparison) == (name, comparison)
    assert abs(measure.value - measure.limit) == pytest.approx(abs(answer.margin))


def test_a_verdict_that_forces_decide_says_over_which_time_they_are_averaged():
    said = "; forces are means over 0.01 s"
    for text in ("always force(Table, box) < 2 N", "2 * force(Table, box) > 9"):
        assert said in verdict(lift_run(), Formula(formula=text)).reason
    other = "always (z(box) > 7 cm implies force(Table, box) < 1 N)"
    assert said not in verdict(lift_run(), Formula(formula=other)).reason


def pressing(force):
    """A run of samples of 1 ms in which the table presses a box."""
    poses, times = {"box": at(len(force))}, np.arange(len(force)) * 1e-3
    forces = {("Table", "box"): force}
    return make_run(len(force), times=times, contact_forces=forces, object_poses=poses)


@pytest.mark.parametrize(
    ("window", "limit", "status"),
    [(0.0, 11, "failed"), (0.01, 3, "passed"), (0.01, 0.8, "failed"), (0.05, 0.5, "passed")],
)
def test_a_force_is_the_mean_over_its_window(window, limit, status):
    """A blow of 12 N for one sample of 1 ms, between samples without contact."""
    blow = np.zeros(200)
    blow[100] = 12.0
    run = pressing(blow)
    formula = Formula(formula=f"always force(Table, box) < {limit}", force_window=window)
    answer = verdict(run, formula)
    assert answer.status == status
    assert ("single steps" if window == 0 else f"means over {window:g} s") in answer.reason


def test_a_force_that_ended_is_exactly_zero():
    """What is left of sums of other forces is no contact."""
    rattling = np.where(np.arange(200) < 100, 0.1 + np.arange(200) % 3 / 7, 0.0)
    run = pressing(rattling)
    formula = Formula(formula="always[0.12, 0.19] force(Table, box) <= 0")
    assert verdict(run, formula).status == "passed"


def test_a_formula_of_every_kind_of_signal():
    run = lift_run(
        clearances={("robot", "box"): np.full(200, 0.1)},
        frames={"arm_link": heights(np.full(200, 0.4))},
    )
    for text in (
        "always distance(robot, box) >= 10 cm",
        "always (force(gripper, box) >= 0 N and tilt(box) < 1 deg)",
        "always abs(position(shoulder) - command(shoulder)) < 0.1 deg",
        "always max(velocity(shoulder), -velocity(shoulder)) <= 2",
        "always effort(finger) * 2 <= 5 + 1 / 2",
        "always z(arm_link) > 0.3",
        "F[0, 1.8] G[0, 100 ms] speed(box) < 1 & time <= 1.99",
        'x("box") < 1 -> y(tcp) < 1',
        "!(z(box) > 1) U z(box) > 0.1",
        "not time < 0",
    ):
        assert verdict(run, Formula(formula=text)).status == "passed", text


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("z(box) / 2 < 1", "m"),
        ("z(box) * 2 < 1", "m"),
        ("2 * z(box) < 1", "m"),
        ("z(box) / time < 1 or z(box) < 1", "m"),
        ("z(box) * z(box) < 1", "1"),
        ("z(box) / (z(box) + 1) < 1", "1"),
        ("max(0, z(box)) < 1", "m"),
        ("-z(box) < 1", "m"),
    ],
)
def test_the_unit_of_a_calculated_signal_is_that_of_its_parts(text, unit):
    assert verdict(make_run(), Formula(formula=text)).unit == unit


def test_what_is_certain_is_decided_by_what_is_known_and_not_by_what_may_come():
    """The first part may fail after the window; the second is as large, and is certain."""
    run = run_of([1.0, 1.0], [1.0, 1.0], [0.0, 0.1])
    formula = parse_formula("(always[0, 5] x(tcp) > 0) or y(tcp) > 0")
    evaluation = Evaluation(window_of(run))
    assert evaluation.bounds(formula).low[0] == 1.0
    node, index, sign = evaluation.decider(formula, 0, at_least=True)
    assert (node.left.name, index, sign) == ("y", 0, 1)


def test_what_must_hold_until_a_later_time_is_decided_by_its_worst_sample_so_far():
    run = run_of([3.0, 2.0, 1.0], [-5.0] * 3, [0.0, 0.1, 0.2])
    formula = parse_formula("x(tcp) > 0 until[0, 5] y(tcp) > 0")
    evaluation = Evaluation(window_of(run))
    assert evaluation.bounds(formula).high[0] == 1.0
    node, index, _ = evaluation.decider(formula, 0, at_least=False)
    assert (node.left.name, index) == ("x", 2)


def test_what_never_comes_is_worth_no_more_than_its_best_sample():
    run = run_of([1.0, 1.0, 1.0], [-2.0, -3.0, -2.5], [0.0, 0.1, 0.2])
    formula = parse_formula("x(tcp) > 0 until y(tcp) > 0")
    bounds = Evaluation(window_of(run)).bounds(formula)
    assert bounds.high.tolist() == bounds.low.tolist() == [-2.0, -2.5, -2.5]


def test_a_window_too_short_for_a_formula_is_not_reached_and_never_a_pass():
    answer = verdict(lift_run(), Formula(formula="always[0, 5] z(box) >= 0"))
    assert answer.status == "not reached"
    assert verdict(lift_run(), Formula(formula="always[0, 5] z(box) >= 1")).status == "failed"
    assert verdict(lift_run(), Formula(formula="eventually[5, 6] time > 0")).status == "not reached"
    absent = make_run(object_poses={"box": np.full((200, 7), np.nan)})
    for text in ("always z(box) > 0", "not eventually z(box) > 1", "z(box) > 0 until time > 1"):
        assert verdict(absent, Formula(formula=text)).status == "not observable", text
    assert verdict(lift_run(), Formula(formula="time >= 0"), "gone").status == "not reached"


def test_a_pending_obligation_is_what_leaves_a_formula_open():
    contact = force(200, (195, 200))
    run = make_run(contact_forces={("left_finger", "box"): contact})
    text = "always (force(gripper, box) > 0.5 implies eventually[0, 0.2] z(box) > 1)"
    assert verdict(run, Formula(formula=text)).status == "not reached"
    early = make_run(contact_forces={("left_finger", "box"): force(200, (50, 60))})
    assert verdict(early, Formula(formula=text)).status == "failed"
    never = make_run()
    assert verdict(never, Formula(formula=text)).status == "passed"


def test_what_the_run_does_not_know_is_not_observable():
    for text in ("z(ghost) > 0", "position(elbow) > 0", "distance(robot, box) > 0"):
        assert verdict(make_run(), Formula(formula=text)).status == "not observable"
    with pytest.raises(NotObservable):
        formula_verdict("z(arm_link) > 0", window_of(make_run()))


@pytest.mark.parametrize(
    ("text", "start", "message"),
    [
        ("always z(box > 1", 13, "`)` is missing after the names of `z`"),
        ("alwys z(box) > 1", 0, "no signal is called `alwys`"),
        ("z(box)", 0, "here is a number; a formula is needed"),
        ("z(box) > 1 and 2", 15, "here is a number; a formula is needed"),
        ("z(box) > force(a, b)", 0, "the formula joins m and N"),
        ("1 < z(box) < 2", 11, "one comparison at a time"),
        ("always[2, 1] time > 0", 6, "an interval ends before it begins"),
        ("always[0, 2 m] time > 0", 10, "an interval is of seconds"),
        ("z(box) > 5 parsec", 11, "no unit is called `parsec`"),
        ("z(box) > 5 ; import os", 11, "`;` has no meaning in a formula"),
        ("z(box) >", 8, "the formula ends too early: a signal or a number is needed"),
        ("force(a) > 1", 6, "`force` is of 2 names, not 1"),
        ("z > 1", 0, "`z` is of one name"),
        ("", 0, "the formula ends too early: a signal or a number is needed"),
        ("(" * 100 + "time > 0" + ")" * 100, 60, "nested more than 60 deep"),
        ("time > 0 " * 400, 0, "a formula has 2000 characters at most; this has 3600"),
        ("__import__('os')", 0, "no signal is called `__import__`"),
    ],
)
def test_a_formula_that_cannot_be_read_is_refused_at_its_place(text, start, message):
    with pytest.raises(FormulaError) as caught:
        parse_formula(text)
    assert caught.value.message == message
    assert caught.value.span[0] == start


EVIDENCE = Evidence(
    mutation_cases=(
        (
            Formula(
                formula="always (z(box) < 0.1 and force(Table, box) > 0.5 and tilt(box) < 0.1"
                ") and eventually z(tcp) > 0.49"
            ),
            shared.standing(tcp_pose=shared.ALONG),
            "late",
        ),
        (
            Formula(formula="eventually (speed(box) > 0.05 and speed(box) < 1)"),
            shared.late(object_poses={"box": shared.SWING}),
            "",
        ),
        (
            Formula(
                formula="always (abs(position(shoulder) - command(shoulder)) < 0.05"
                " and velocity(shoulder) < 0.1 and effort(shoulder) < 2"
                " and distance(robot, box) > 0.01)"
            ),
            shared.late(**shared.MOVING, clearances={("robot", "box"): shared.DISTANT}),
            "late",
        ),
    ),
    free_shifts=(
        Free("further away is clear", "formula 3", "clearances", "+"),
        Free("the formula requires `force > 0.5`", "formula", "contact_forces", "+"),
        Free(
            "the formula requires `z(box) < 0.1` and a tilt",
            "formula",
            "object_poses",
            "+-x +-y -z +-yaw",
        ),
        Free(
            "the formula requires `z(tcp) > 0.49`",
            "formula",
            "tcp_pose",
            "+-x +-y +z +-roll +-pitch +-yaw",
        ),
        Free(
            "turning is no speed of the origin", "formula 2", "object_poses", "+-roll +-pitch +-yaw"
        ),
        Free(
            "the same motion elsewhere is as fast",
            "formula 2",
            "object_poses",
            "+-x +-y +-z",
            (AT_ONCE,),
        ),
        Free(
            "the formula does not name the finger",
            "formula 3",
            "joint_positions, joint_commands, joint_velocities, joint_efforts",
            "+-finger",
        ),
        Free(
            "the formula requires less than a limit",
            "formula 3",
            "joint_velocities, joint_efforts",
            "-shoulder",
        ),
    ),
)


@pytest.mark.parametrize("way", ["always", "eventually", "always not"])
def test_a_quotient_by_zero_is_not_observable_and_says_so(way):
    """At the third sample y is 0; a quotient of zeros and one of a length are none either."""
    run = run_of([0.0, 1.0, 0.0, 1.0], [1.0, 1.0, 0.0, 1.0], [0.0, 0.01, 0.02, 0.03])
    limit = 9 if way == "eventually" else -9 if way == "always" else 9
    answer = verdict(run, Formula(formula=f"{way} x(tcp) / y(tcp) > {limit}"))
    assert answer.status == "not observable"
    assert "x(tcp) / y(tcp) >" in answer.reason
    assert answer.reason.endswith("has no value at t=0.020 s, where it divides by zero")
