"""In every scene the naive check passes and the harness' check fails; the page says the same."""

import pytest

from tests.adversarial.scenes import SCENES
from tests.adversarial.table import PAGE, RENEW, page, row_of, run_scene, without_numbers


@pytest.fixture(scope="module")
def run_of(tmp_path_factory):
    """Each scene's result and run, run once."""
    known = {}

    def run(scene):
        if scene.title not in known:
            known[scene.title] = run_scene(scene, tmp_path_factory.mktemp("scene"))
        return known[scene.title]

    return run


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.title)
def test_the_naive_check_is_fooled_and_the_harness_is_not(scene, run_of):
    result, run = run_of(scene)
    assert scene.says(run), f"the naive check would not be fooled: {scene.naive}"
    refuted, kept = result.verdicts[: len(scene.expect)], result.verdicts[len(scene.expect) :]
    assert len(refuted) == len(scene.expect)
    for verdict in refuted:
        assert verdict.status != "passed", verdict
        assert verdict.reason, verdict
    assert [verdict.status for verdict in kept] == ["passed"] * len(scene.stays), kept


def test_the_page_of_verdicts_is_current(run_of):
    said = page([row_of(scene, run_of(scene)[0]) for scene in SCENES])
    assert without_numbers(PAGE.read_text(encoding="utf-8")) == without_numbers(said), RENEW
