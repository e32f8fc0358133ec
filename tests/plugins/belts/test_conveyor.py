"""Belts in scenario files: what they carry, and which files are refused."""

import pytest

from tests.running import run_case

BELT = "{name: belt, static: true, box: {size: [1.2, 0.3, 0.1]}, pose: {xyz: [0.4, 0, 0.05]}"
BOX = "{name: box, box: {size: [0.04, 0.04, 0.04]}, mass: 0.1, pose: {xyz: [0.3, 0.1, 0.12]}}"


def run(folder, steps, objects=(BELT + ", surface_velocity: 0}", BOX), expect=""):
    path = folder / "belt.scenario.yaml"
    path.write_text(
        "\n".join(
            [
                "scenario: belt",
                "robot: {model: open_manipulator_x, base: {xyz: [0, -0.5, 0]}}",
                "objects:",
                *(f"  - {each}" for each in objects),
                "steps:",
                *(f"  - {each}" for each in steps),
                expect,
            ]
        ),
        encoding="utf-8",
    )
    return run_case(path)


def test_a_belt_carries_as_far_as_its_speed_and_both_ramps_say(tmp_path):
    result = run(
        tmp_path,
        [
            "conveyor: {object: belt, velocity: 10 cm/s}",
            "wait: 1",
            "conveyor: {object: belt, velocity: 0, ramp: 0.4}",
            "settle: {}",
        ],
        expect="expect: [{placed: {object: box, on: belt, pose: {xyz: [0.43, 0.1, 0.12]},"
        " tolerance: {position: 0.2 mm}}}]",
    )
    assert result.outcome == "passed", (result.problems, result.verdicts)
    assert result.sim_time > 1.6


def test_a_belt_that_moves_from_the_start_needs_no_step(tmp_path):
    belt = BELT + ", surface_velocity: [0, 5 cm/s, 0]}"
    expect = "expect: [{displaced: {object: box, at_least: 48 mm}}, {eventually: {static: box}}]"
    result = run(tmp_path, ["wait: 1"], (belt, BOX), expect)
    assert [each.status for each in result.verdicts] == ["passed", "failed"]
    assert result.verdicts[0].margin == pytest.approx(0.002, abs=1e-3)


def test_what_a_belt_carries_does_not_come_to_rest(tmp_path):
    result = run(tmp_path, ["{settle: {}, timeout: 1}"], (BELT + ", surface_velocity: 0.05}", BOX))
    assert result.steps, result.problems
    assert "box still moves with 0.05 m/s after 1 s" in result.steps[0].message


@pytest.mark.parametrize(
    ("objects", "step", "messages"),
    [
        (
            [BELT + "}", BOX],
            "{object: belt, velocity: 0.1}",
            ["the surface of 'belt' does not move", "add `surface_velocity: 0` to 'belt'"],
        ),
        (
            [BELT + ", surface_velocity: 0}", BOX],
            "{object: box, velocity: 0.1}",
            ["'box' does not move: it is not static", "or name one of belt"],
        ),
        (
            ["{name: belt, box: {size: [1, 1, 0.1]}, surface_velocity: 0.1}"],
            "{object: belt, velocity: 0.1}",
            ["only the surface of a static object moves: add `static: true`"],
        ),
        (
            ["{name: disc, cylinder: {radius: 0.1, length: 0.1}, surface_rotation: 0.1}"],
            "{object: disc, rotation: 0.1}",
            ["only the surface of a static object moves"],
        ),
        (
            [BELT + ", conveyor: 0.1}"],
            "{object: belt, velocity: 0.1}",
            ["a belt is an object with `static: true` and `surface_velocity: 0.1`"],
        ),
        (
            [BELT + ", surface_velocity: 0}"],
            "{object: belt}",
            ["at least one of `velocity` and `rotation` is needed"],
        ),
        (
            [BELT + ", surface_velocity: 0}"],
            "{object: belt, velocity: 10 cm}",
            ["`10 cm` is a length; a speed is expected"],
        ),
        (
            [BELT + ", surface_velocity: 0}"],
            "{object: bolt, velocity: 0.1}",
            ["there is no object 'bolt'", "belt"],
        ),
        (
            [BELT + ", surface_velocity: 0, in: planning}"],
            "{object: belt, velocity: 0.1}",
            ["'belt' is known to the planner alone"],
        ),
    ],
)
def test_what_is_no_belt_is_refused_where_it_stands(tmp_path, objects, step, messages):
    result = run(tmp_path, [f"conveyor: {step}"], objects)
    text = "\n".join(f"{each.message}; {each.hint}" for each in result.problems)
    assert all(message in text for message in messages), text
    assert all(problem.line > 3 for problem in result.problems)


def test_formulas_read_the_velocity_of_a_belt_as_it_was_driven(tmp_path):
    table = "{name: table, static: true, cylinder: {radius: 0.2, length: 0.1},"
    table += " pose: {xyz: [-1, 1, 0.05]}, surface_rotation: -30 deg/s}"
    formulas = [
        "eventually always surface_velocity(belt) >= 0.1",
        "always abs(surface_velocity(belt)) <= 10 cm/s",
        "eventually (surface_velocity(belt) > 4 cm/s and surface_velocity(belt) < 6 cm/s)",
        "always surface_rotation(table) <= -29 deg / s",
        "always surface_velocity(belt) < 9 cm/s",
    ]
    result = run(
        tmp_path,
        ["conveyor: {object: belt, velocity: 10 cm/s}", "wait: 0.5"],
        (BELT + ", surface_velocity: 0}", table),
        "expect: [" + ", ".join(f"{{formula: '{each}'}}" for each in formulas) + "]",
    )
    assert not result.problems
    assert [each.status for each in result.verdicts] == ["passed"] * 4 + ["failed"]
    assert result.verdicts[-1].time == pytest.approx(0.2, abs=2e-3)  # the end of the ramp


def test_a_formula_that_reads_the_surface_of_what_is_no_belt_is_refused(tmp_path):
    expect = "expect: [{formula: 'always surface_velocity(box) > 0'}]"
    result = run(tmp_path, ["wait: 0.1"], expect=expect)
    [problem] = result.problems
    assert "belt or turntable 'box'" in problem.message
