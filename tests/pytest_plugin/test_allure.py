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
    """Each test's name with the contents of its attachments."""
    found = {}
    for file in folder.glob("*-result.json"):
        result = json.loads(file.read_text())
        listed = result.get("attachments", [])
        assert all(each["type"] == "text/html" for each in listed)
        found[result["name"]] = [(folder / each["source"]).read_text() for each in listed]
    return found


def test_the_page_of_a_scenario_is_attached_to_its_test(pytester):
    pytester.path.joinpath("a.scenario.yaml").write_text(SCENARIO)
    done = pytester.runpytest_subprocess("--alluredir", "allure", "--harness-in-process")
    done.assert_outcomes(passed=1)
    [page] = attachments(pytester.path / "allure")["Stands still"]
    assert "<html" in page
    assert "Stands still" in page


def test_without_the_option_nothing_is_attached(pytester):
    pytester.path.joinpath("a.scenario.yaml").write_text(SCENARIO)
    pytester.runpytest_subprocess("--harness-in-process").assert_outcomes(passed=1)
    assert not (pytester.path / "allure").exists()
