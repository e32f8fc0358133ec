"""`harness check --format sarif`."""

import json

import jsonschema
import pytest

from harness.cli.main import main

TEXT = {"type": "object", "required": ["text"]}
RESULT = {
    "required": ["ruleId", "message", "locations"],
    "properties": {
        "level": {"enum": ["none", "note", "warning", "error"]},
        "message": TEXT,
        "locations": {
            "minItems": 1,
            "items": {
                "required": ["physicalLocation"],
                "properties": {
                    "physicalLocation": {
                        "required": ["artifactLocation"],
                        "properties": {
                            "artifactLocation": {
                                "required": ["uri"],
                                "properties": {"uri": {"pattern": r"^[^\s\\]+$"}},
                            },
                            "region": {
                                "required": ["startLine"],
                                "additionalProperties": {"type": "integer", "minimum": 1},
                            },
                        },
                    }
                },
            },
        },
    },
}
SARIF = {
    "type": "object",
    "required": ["version", "runs"],
    "properties": {
        "version": {"const": "2.1.0"},
        "runs": {
            "type": "array",
            "items": {
                "required": ["tool", "results"],
                "properties": {
                    "tool": {
                        "required": ["driver"],
                        "properties": {"driver": {"required": ["name"]}},
                    },
                    "columnKind": {"enum": ["utf16CodeUnits", "unicodeCodePoints"]},
                    "results": {"type": "array", "items": RESULT},
                },
            },
        },
    },
}
"""What SARIF 2.1.0 and code scanning require of the parts that are written."""

BASE = "scenario: A\nrobot: {model: open_manipulator_x}\nworld: empty\n"
INVALID = (
    f"{BASE}steps:\n  - move_to: nowhere\n  - wiat: 1 s\nexpect: [{{always: within_limits}}]\n"
)
FAR = f"{BASE}steps:\n  - move_to: {{pose: {{frame: world, xyz: [9, 0, 0.1], rpy: [0, 0, 0]}}}}\n"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def checked(capsys, *files):
    code = main(["check", "--format", "sarif", *files])
    document = json.loads(capsys.readouterr().out)
    jsonschema.Draft7Validator(SARIF).validate(document)
    [run] = document["runs"]
    rules = [rule["id"] for rule in run["tool"]["driver"]["rules"]]
    assert all(rules[each["ruleIndex"]] == each["ruleId"] for each in run["results"])
    return code, run["results"]


def places(results):
    found = []
    for result in results:
        [location] = result["locations"]
        place = location["physicalLocation"]
        found.append((place["artifactLocation"]["uri"], place["region"]["startLine"]))
    return found


def test_each_mistake_is_a_result_at_its_line(folder, capsys):
    (folder / "my arm").mkdir()
    (folder / "my arm/bad.scenario.yaml").write_text(INVALID)
    code, results = checked(capsys, "my arm/bad.scenario.yaml")
    assert code == 2
    assert {each["ruleId"] for each in results} == {"invalid-file"}
    assert places(results) == [("my%20arm/bad.scenario.yaml", line) for line in (5, 6)]


def test_a_goal_out_of_reach_is_a_result_of_another_rule(folder, capsys):
    (folder / "far.scenario.yaml").write_text(FAR)
    code, results = checked(capsys, "far.scenario.yaml")
    assert (code, [each["ruleId"] for each in results]) == (1, ["step-will-fail"])
    assert places(results) == [("far.scenario.yaml", 5)]


def test_files_without_mistakes_have_no_results(capsys):
    assert checked(capsys, "lessons/04_gripper_alone") == (0, [])


def test_a_file_that_cannot_be_read_as_yaml_is_a_result_too(folder, capsys):
    (folder / "x.scenario.yaml").write_text("a: [1\n")
    code, results = checked(capsys, str(folder / "x.scenario.yaml"))
    assert code == 2
    assert len(results) == 1
