"""Sixty cases, twice in random order with two workers, alone and under load: one digest each."""

import json
import subprocess
import sys
from xml.etree import ElementTree as ET

import numpy as np
import pytest

import harness
from harness.core.resources import data_folder

pytestmark = pytest.mark.nightly
LESSONS = data_folder("scenarios") / "lessons"
ARMS = ["ur3e", "ur5e"]
CASES = {
    "04_ur_pick_by_friction": {"robot.model": ARMS, "seed": list(range(1, 11))},
    "03_ur_sixteen_steps": {"robot.model": ARMS, "seed": list(range(1, 8))},
    "01_open_manipulator_first_steps": {"seed": list(range(1, 11))},
    "02_open_manipulator_inverse_kinematics": {"seed": list(range(1, 7))},
    "04_gripper_alone": {"seed": list(range(1, 7))},
    "05_fails_on_purpose": {"robot.model": ARMS, "seed": list(range(1, 4))},
}
MOVED = {
    "04_ur_pick_by_friction": "green_cylinder",
    "03_ur_sixteen_steps": "green_cylinder",
    "01_open_manipulator_first_steps": "red_box",
}
"""What each lesson carries between its fingers."""


@pytest.fixture(scope="module")
def suite(tmp_path_factory):
    folder = tmp_path_factory.mktemp("suite")
    for name, grid in CASES.items():
        text = (LESSONS / f"{name}.scenario.yaml").read_text()
        (folder / f"{name}.scenario.yaml").write_text(f"{text}\nparametrize: {json.dumps(grid)}\n")
    return folder


def digests(suite, *options):
    """Digest of every case as pytest reports it; each must have passed."""
    report = suite / "junit.xml"
    words = ["-q", "-p", "no:cacheprovider", "--harness-no-report", f"--junitxml={report}"]
    command = [sys.executable, "-m", "pytest", "--rootdir", str(suite), *words, *options]
    done = subprocess.run(command, cwd=suite, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-3000:]
    found = {}
    for case in ET.parse(report).iter("testcase"):
        values = {each.attrib["name"]: each.attrib["value"] for each in case.iter("property")}
        found[case.attrib["name"]] = values["digest"]
    return found


@pytest.fixture(scope="module")
def first(suite):
    return digests(suite, "-n", "2", "--randomly-seed=1")


def test_there_are_sixty_cases_of_which_thirty_move_an_object_by_contact():
    counts = {name: int(np.prod([len(v) for v in grid.values()])) for name, grid in CASES.items()}
    assert sum(counts.values()) >= 60
    assert sum(counts[name] for name in MOVED) >= 30
    for name, thing in MOVED.items():
        for model in CASES[name].get("robot.model", [None]):
            overrides = {"robot.model": model} if model else None
            result = harness.run(LESSONS / f"{name}.scenario.yaml", overrides=overrides)
            assert result, str(result)
            signals = result.run.signals
            path = signals.object_poses[thing][:, :3]
            pressed = [f for pair, f in signals.contact_forces.items() if thing in pair]
            assert np.nanmax(np.linalg.norm(path - path[0], axis=1)) > 0.03
            assert max(force.max() for force in pressed) > 1.0


def test_two_workers_in_random_order_reach_the_same_digests_twice(suite, first):
    again = digests(suite, "-n", "2", "--randomly-seed=2")
    assert len(first) >= 60
    assert again == first


def test_a_case_alone_repeated_and_under_load_has_the_digest_of_the_suite(suite, first):
    busy = [
        subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(4)
    ]  # fmt: skip
    try:
        for name in MOVED:
            file = suite / f"{name}.scenario.yaml"
            case = "ur5e-3" if "ur" in name else "3"
            command = ["run", str(file), "--case", case, "--repeat", "3", "--no-report", "--json"]
            done = subprocess.run(
                [sys.executable, "-m", "harness.cli", *command], capture_output=True, check=False
            )
            cases = json.loads(done.stdout)["cases"]
            [(_, digest)] = [
                (key, value) for key, value in first.items()
                if key.endswith(f"[{case}]") and key.startswith(cases[0]["title"])
            ]  # fmt: skip
            assert [each["digest"] for each in cases] == [digest] * 3
    finally:
        for process in busy:
            process.kill()
            process.wait()
