"""Facts of a run are computed once while it is judged."""

from harness.judging.facts import fact, remembered_facts
from tests.judging.synthetic_run import make_run


def test_a_fact_is_computed_once_for_each_argument_and_each_judged_run():
    computed = []

    @fact
    def name_of(run, name):
        computed.append(name)
        return f"{run.seed} {name}"

    runs = [make_run(), make_run()]
    for run in runs:
        with remembered_facts():
            assert name_of(run, "a") == name_of(run, "a") == f"{run.seed} a"
            name_of(run, "b")
    assert computed == ["a", "b", "a", "b"]
    name_of(runs[0], "a")
    name_of(runs[0], "a")
    assert computed[4:] == ["a", "a"]
