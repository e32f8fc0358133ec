"""A case is named by the title of its file, whatever its outcome is."""

import pytest

from harness.session.run_request import RunRequest
from harness.suite.cases import error_result, run_here, run_job

FILES = [
    ("scenario: Lift it\nrobot: ur3e\nsteps: [{pikc: cube}]\n", "Lift it"),
    ("scenario: Lift it\nrobot: no_such_arm\nsteps: [{wait: 1 s}]\n", "Lift it"),
    ("scenario: Lift ${what}\nparams: {what: it}\nrobot: ur3e\nstep: []\n", "Lift it"),
    ("robot: ur3e\nsteps: [{pikc: cube}]\n", "a.scenario.yaml"),
    ("scenario: [1]\nrobot: ur3e\nsteps: [{wait: 1 s}]\n", "a.scenario.yaml"),
    ("scenario: Lift it\nrobot: {ur3e\n", "a.scenario.yaml"),
]


@pytest.mark.parametrize(("text", "title"), FILES)
def test_invalid_files_and_broken_cases_have_the_title_of_their_file(tmp_path, text, title):
    job = RunRequest(tmp_path / "a.scenario.yaml", page=False)
    job.file.write_text(text)
    [(_, result)] = run_here([job], function=run_job)
    assert (result.outcome, result.title) == ("invalid", title)
    assert error_result(job, "why").title == title
