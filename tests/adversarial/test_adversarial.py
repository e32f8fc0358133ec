"""In every scene the naive check passes and the harness' check fails; the page says the same."""

import pytest

from tests.adversarial.file_scenes import FILES
from tests.adversarial.folder_scenes import ENVIRONMENTS, FOLDERS, ROBOTS, report_on, saved_run
from tests.adversarial.recording_scenes import RECORDINGS, graded_scene, recorded_run
from tests.adversarial.rules import RULES
from tests.adversarial.table import (
    ALL_SCENES,
    PAGE,
    RENEW,
    checked,
    environment_row,
    file_row,
    folder_row,
    page,
    parts_of,
    recording_parts,
    recording_row,
    row_of,
    run_scene,
    without_numbers,
)

TITLES = {scene.title for scene in ALL_SCENES}
REPRESENTATIVES = {rule.fires[0] for rule in RULES} & TITLES
"""Of each rule a scene in which it fires."""


@pytest.fixture(scope="module")
def run_of(tmp_path_factory):
    """Each scene's result and run, run once."""
    known = {}

    def run(scene):
        if scene.title not in known:
            known[scene.title] = run_scene(scene, tmp_path_factory.mktemp("scene"))
        return known[scene.title]

    return run


@pytest.mark.nightly(but=REPRESENTATIVES)
@pytest.mark.parametrize("scene", ALL_SCENES, ids=lambda scene: scene.title)
def test_the_naive_check_is_fooled_and_the_harness_is_not(scene, run_of):
    result, run = run_of(scene)
    assert scene.truth(run), f"it is not so: {scene.happens}"
    assert scene.says(run), f"the naive check would not be fooled: {scene.naive}"
    refuted, warned, kept = parts_of(scene, result)
    assert len(refuted) == len(scene.expect)
    assert [verdict.status for verdict in warned] == ["passed"] * len(scene.warned), warned
    assert all(verdict.warnings for verdict in warned), warned
    assert not [verdict for verdict in kept if verdict.warnings], kept
    for verdict in refuted:
        assert verdict.status != "passed", verdict
        assert verdict.reason, verdict
    assert [verdict.status for verdict in kept] == ["passed"] * len(scene.stays), kept


@pytest.fixture(scope="module")
def grade_of(tmp_path_factory):
    """Each damaged recording and its grade, graded once."""
    folder, known = tmp_path_factory.mktemp("recordings"), {}

    def grade(scene):
        if scene.title not in known:
            known[scene.title] = graded_scene(scene, recorded_run(folder), folder)
        return known[scene.title]

    return grade


@pytest.mark.parametrize("scene", RECORDINGS, ids=lambda scene: scene.title)
def test_a_recording_that_fools_the_naive_check_earns_no_points(scene, grade_of):
    recording, grade = grade_of(scene)
    assert scene.says(recording), f"the naive check would not be fooled: {scene.naive}"
    lost, kept = recording_parts(scene, grade)
    found = [row.withheld[0] if row.withheld else row.verdict.status for row in lost]
    assert found == list(scene.expect.values()), lost
    assert all(row.earned == 0 for row in lost)
    assert all(row.points > 0 for row in kept)
    assert all(row.earned == (0 if scene.is_idle else row.points) for row in kept), kept


@pytest.mark.parametrize("scene", FILES, ids=lambda scene: scene.title)
def test_a_file_that_says_something_else_than_it_seems_is_refused(scene, tmp_path):
    problems = checked(scene, tmp_path)
    assert bool(problems) == bool(scene.says), problems
    assert all(scene.says in problem.message for problem in problems)


@pytest.fixture(scope="module")
def said_of(tmp_path_factory):
    """Each changed folder and what is said of it, computed once."""
    folder, known = tmp_path_factory.mktemp("folders"), {}
    runs = {robot: saved_run(folder, robot) for robot in ROBOTS}

    def said(scene):
        if scene.title not in known:
            known[scene.title] = report_on(scene, runs, folder)
        return known[scene.title]

    return said


@pytest.mark.parametrize("scene", FOLDERS, ids=lambda scene: scene.title)
def test_a_saved_run_that_was_written_over_is_called_so(scene, said_of):
    report, text = said_of(scene)
    assert scene.is_fooled(report), f"the naive check would not be fooled: {scene.naive}"
    assert scene.said in text
    assert bool(scene.said) or "changed" not in text


@pytest.fixture(scope="module")
def exit_code_in(tmp_path_factory):
    """The exit code in each environment, run once."""
    folder, known = tmp_path_factory.mktemp("environments"), {}

    def exit_code(scene):
        if scene.title not in known:
            known[scene.title] = scene.exit_code(folder)
        return known[scene.title]

    return exit_code


@pytest.mark.nightly
@pytest.mark.parametrize("scene", ENVIRONMENTS, ids=lambda scene: scene.title)
def test_a_run_goes_on_in_any_environment(scene, exit_code_in):
    assert exit_code_in(scene) == 1, "its expectation fails"


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.title)
def test_every_rule_has_three_scenes_and_one_in_which_it_must_not_fire(rule):
    scenes = (*ALL_SCENES, *RECORDINGS, *FILES, *FOLDERS, *ENVIRONMENTS)
    titles = {scene.title for scene in scenes}
    assert {*rule.fires, *rule.silent} <= titles
    assert not set(rule.fires) & set(rule.silent)
    assert len(rule.fires) + len(rule.silent) >= 3
    assert rule.silent


@pytest.mark.nightly
def test_the_page_of_verdicts_is_current(run_of, grade_of, said_of, exit_code_in, tmp_path):
    said = page(
        [row_of(scene, run_of(scene)[0]) for scene in ALL_SCENES],
        [recording_row(scene, grade_of(scene)[1]) for scene in RECORDINGS],
        [file_row(scene, checked(scene, tmp_path)) for scene in FILES],
        [folder_row(scene, said_of(scene)[1]) for scene in FOLDERS],
        [environment_row(scene, exit_code_in(scene)) for scene in ENVIRONMENTS],
    )
    assert without_numbers(PAGE.read_text(encoding="utf-8")) == without_numbers(said), RENEW
