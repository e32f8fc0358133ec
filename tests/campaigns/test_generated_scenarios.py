"""Random valid scenarios end with an outcome, the same when they are run again."""

import pytest

from tests.campaigns.generated import drawn_scenario, ends_well, is_read


@pytest.mark.nightly(but=["0", "1", "2"])
@pytest.mark.parametrize("seed", range(60))
def test_a_drawn_scenario_ends_with_an_outcome_and_one_digest(seed, tmp_path):
    end, _ = ends_well(seed, tmp_path)
    assert end in ("passed", "failed", "refused")


def test_most_words_of_the_language_are_drawn():
    """And what is drawn is read; the test could not fail where nothing is."""
    drawn = [drawn_scenario(seed) for seed in range(12)]
    assert all(map(is_read, drawn))
    verbs = {verb for each in drawn for step in each["steps"] for verb in step}
    assert len(verbs) > 8, verbs
    assert any(each.get("expect") for each in drawn)
