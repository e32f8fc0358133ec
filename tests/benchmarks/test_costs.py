"""How costs grow: with objects, with the length of a run, with expectations, with cases.

Each figure is processor time. The last column is the time for the tenfold (or largest) size over
what linear growth from the smallest size allows; 1 is linear, less is better than linear.
docs/guides/costs.md has a run of it.
"""

import time

import pytest

from tests.benchmarks.test_suites import blinks, open_server, timed
from tests.running import run_case

pytestmark = pytest.mark.benchmark
HEADING = "how costs grow, processor time"
OBJECTS, MINUTES, EXPECTATIONS, CASES = (10, 100, 500), (1, 10), (10, 100, 1000), (100, 1000)
HEAD = "scenario: Costs\nrobot: {model: open_manipulator_x}\n"
MOVES = "  - move_to: home\n  - ptp: {joints: {joint1: 0.5}}\n"


def run(folder, text, **options):
    """Processor seconds of a run."""
    file = folder / "costs.scenario.yaml"
    file.write_text(text)
    begin = time.process_time()
    result = run_case(file, **options)
    assert result.outcome == "passed", (result.message, result.problems)
    return time.process_time() - begin


@pytest.fixture
def print_growth(print_row):
    def growth(what, unit, seconds):
        """A line for each size, with the time per unit and the growth against a linear one."""
        sizes = sorted(seconds)
        for size in sizes:
            linear = seconds[sizes[0]] * size / sizes[0]
            share = "" if size == sizes[0] else f"{seconds[size] / linear:.2f}x linear"
            each = f"{1000 * seconds[size] / size:.3g} ms a {unit}"
            print_row(HEADING, what, f"{size} {unit}s", f"{seconds[size]:.2f} s", each, share)

    return growth


@pytest.fixture(scope="module")
def warm(tmp_path_factory):
    """Everything imported and loaded once."""
    run(tmp_path_factory.mktemp("warm"), f"{HEAD}steps:\n{MOVES}")


def grid_of_boxes(count):
    """Static boxes on a grid in front of the arm and out of its reach."""
    lines = ["objects:"]
    for number in range(count):
        x, y = 0.5 + 0.05 * (number // 25), 0.05 * (number % 25) - 0.6
        lines += [
            f"  - {{name: box{number}, box: {{size: [2 cm, 2 cm, 2 cm]}}, static: true,",
            f"     pose: {{xyz: [{x:.2f}, {y:.2f}, 0.01]}}}}",
        ]
    return "\n".join(lines) + "\n"


@pytest.mark.usefixtures("warm")
def test_a_scene_of_many_objects(tmp_path, print_growth):
    seconds = {}
    for count in OBJECTS:
        text = f"{HEAD}{grid_of_boxes(count)}steps:\n{MOVES}expect:\n  - never: collision\n"
        seconds[count] = run(tmp_path, text)
    print_growth("a motion among objects", "object", seconds)


@pytest.mark.usefixtures("warm")
def test_a_long_run(tmp_path, print_growth):
    seconds = {}
    for minutes in MINUTES:
        text = f"{HEAD}steps:\n  - wait: {60 * minutes} s\nexpect:\n  - always: within_limits\n"
        folder = tmp_path / str(minutes)
        seconds[minutes] = run(tmp_path, text, report_dir=folder, stills=False)
    print_growth("a run, judged and reported", "minute", seconds)


@pytest.mark.usefixtures("warm")
def test_many_expectations(tmp_path, print_growth):
    seconds, without = {}, run(tmp_path, f"{HEAD}steps:\n{MOVES}")
    for count in EXPECTATIONS:
        goal = "joints: {positions: {joint1: 0.25}, tolerance: "
        expected = "".join(
            f"  - always: {{{goal}{1 + number / 1000:.3f}}}}}\n" for number in range(count)
        )
        seconds[count] = run(tmp_path, f"{HEAD}steps:\n{MOVES}expect:\n{expected}") - without
    print_growth("expectations of a run", "expectation", seconds)


def test_a_suite_of_many_cases(tmp_path, print_growth):
    seconds = {}
    with open_server() as server:
        for count in CASES:
            folder = tmp_path / str(count)
            folder.mkdir()
            seconds[count] = count * timed(server, blinks(folder, count), workers=2)[1]
    print_growth("a suite of short samples", "case", seconds)
