"""Final paths, judged by Coal alone on states that the planner did not choose."""

import pytest

from tests.benchmarks.planning.contenders import is_free, ours
from tests.benchmarks.planning.problems import EXACT, make_problems

EACH = 30
"""Problems of each family: 210, of which 35 are those of `test_planning`."""

FREE_SHARE = 0.995


@pytest.mark.benchmark
def test_final_paths_are_free_on_the_exact_shapes(print_row):
    solved, touching = 0, []
    problems = make_problems(EXACT, EACH)
    for problem in problems:
        outcome = ours(problem, "always")
        if outcome.waypoints is None:
            continue
        solved += 1
        if not is_free(problem, outcome.waypoints):
            touching.append(problem.name)
    heading = "final paths, by Coal alone at 1/128 rad"
    print_row(heading, "problems", "solved", "free", "touching")
    free = solved - len(touching)
    print_row(
        heading,
        *(f"{count}" for count in (len(problems), solved, free)),
        ", ".join(touching) or "none",
    )
    assert solved == len(problems)
    assert free >= FREE_SHARE * solved
