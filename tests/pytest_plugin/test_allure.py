"""Reports in the results of Allure, where allure-pytest is installed."""

import json

import pytest

from tests.installed import is_installed

pytestmark = pytest.mark.skipif(not is_installed("allure-pytest"), reason="needs allure-pytest")
SCENARIO = """\
scenario: Stands still
robot: {model: open_manipulator_x}
world: empty
steps: [{wait: 0.1 s}]
expect: [{always: within_limits}]
"""


def attachments(folder):
    """Each test's name with kinds and contents of its attachments."""
    found = {}
    for file in folder.glob("*-result.json"):
        result = json.loads(file.read_text())
        listed = result.get("attachments", [])
        found[result["name"]] = [
            (each["type"], (folder / each["source"]).read_bytes()) for each in listed
        ]
    return found


@pytest.mark.nightly
def test_the_page_of_a_scenario_is_attached_to_its_test(pytester):
    pytester.path.joinpath("a.scenario.yaml").write_text(SCENARIO)
    done = pytester.runpytest_subprocess("--alluredir", "allure", "--harness-in-process")
    done.assert_outcomes(passed=1)
    [margins, page] = attachments(pytester.path / "allure")["Stands still"]
    assert margins[0] == "text/csv"
    assert b"always: joints are within limits,,passed,0." in margins[1]
    assert page[0] == "text/html"
    assert b"Stands still" in page[1]


def test_the_picture_of_a_failure_is_attached_too(pytester):
    failing = SCENARIO.replace("[{always: within_limits}]", "[{never: within_limits}]")
    pytester.path.joinpath("a.scenario.yaml").write_text(failing)
    done = pytester.runpytest_subprocess("--alluredir", "allure", "--harness-in-process")
    done.assert_outcomes(failed=1)
    found = attachments(pytester.path / "allure")["Stands still"]
    assert [kind for kind, _ in found] == ["text/csv", "image/jpg", "text/html"]
    assert found[1][1].startswith(b"\xff\xd8")


@pytest.mark.nightly
def test_without_the_option_nothing_is_attached(pytester):
    pytester.path.joinpath("a.scenario.yaml").write_text(SCENARIO)
    pytester.runpytest_subprocess("--harness-in-process").assert_outcomes(passed=1)
    assert not (pytester.path / "allure").exists()
