"""The worked example: a student's solver with two mistakes, and the corrected one."""

import json
import re

import cv2
import numpy as np
import pytest

from docs import ROOT
from harness.cli.main import main
from harness.plugins.iktest.strategies import load_chain

EXAMPLES = ROOT / "scenarios/ik_test"
ARM = ["--robot", "open_manipulator_x"]
STUDENT = "scenarios/ik_test/student_ik.py:ik"
PAGE = ROOT / "docs/guides/ik_test.md"


@pytest.mark.nightly
def test_both_mistakes_are_found_each_with_its_smallest_example(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(ROOT)
    assert main(["ik-test", STUDENT, *ARM, "--report-dir", str(tmp_path)]) == 1
    folder = tmp_path / "ik_test" / "student_ik.ik"
    facts = json.loads((folder / "ik_test.json").read_text())
    height, turn = facts["findings"][:2]
    home = load_chain("open_manipulator_x").home

    assert height["property"] == turn["property"] == "reaches"
    assert height["kind"] == "is off by (0.0, 0.0, -17.0) mm in the world's axes, at every target"
    assert height["asked_joint_positions"] == home.tolist()
    assert np.subtract(height["reached"], height["asked"])[:3] == pytest.approx([0, 0, -0.017])

    # The smallest example of atan: one joint off home puts the tip just past joint 1's axis.
    away = np.subtract(turn["asked_joint_positions"], home)
    assert np.count_nonzero(np.abs(away) > 1e-9) == 1
    assert -0.01 < turn["asked"][0] - 0.012 < 0
    mirrored = turn["reached"][0] - 0.012
    assert mirrored == pytest.approx(0.012 - turn["asked"][0])

    for finding in facts["findings"]:
        assert cv2.imread(str(folder / finding["picture"])).shape == (480, 640, 3)
    said = capfd.readouterr().out.replace(str(tmp_path), "reports")
    [shown] = re.findall(r"(?ms)^\$ harness ik-test .*?student_ik.*?\n(.*?)^```$", PAGE.read_text())
    assert without_times(said) == without_times(shown)


def without_times(text):
    """Text of a report but for what the wall clock gave."""
    return re.sub(r"(?m)(?<=^  speed).*| in [0-9.]+ s$", "", text)


@pytest.mark.nightly
def test_the_corrected_solver_passes_and_finds_every_way(tmp_path, capfd):
    solver = f"{EXAMPLES / 'corrected_ik.py'}:ik"
    assert main(["ik-test", solver, *ARM, "--branches", "--report-dir", str(tmp_path)]) == 0
    text = capfd.readouterr().out
    assert "nothing found in" in text
    assert text.count("ok, ") == 8
    assert re.search(r"speed +\d+ us median", text)


def test_only_the_two_mistakes_part_the_two_files():
    wrong, right = ((EXAMPLES / name).read_text().splitlines()
                    for name in ("student_ik.py", "corrected_ik.py"))  # fmt: skip
    differing = [(a, b) for a, b in zip(wrong, right, strict=True) if a != b]
    assert len(differing) == 4  # the first line, the import, and the two
    assert differing[2:] == [
        ("SHOULDER_Z = 0.0765  # joint 2, above the base's origin",
         "SHOULDER_Z = 0.0595  # joint 2, above the base's origin"),
        ("    facing = atan(y / (x - BASE_X))", "    facing = atan2(y, x - BASE_X)"),
    ]  # fmt: skip


@pytest.mark.nightly(but=[3, 6])
@pytest.mark.parametrize(
    ("arguments", "reported"),
    [
        (["mine.py:ik", *ARM], "no such file: 'mine.py'"),
        (["mine:ik", *ARM], "no module 'mine'"),
        (["mine", *ARM], "'mine' is not module:function or file.py:function"),
        ([f"{EXAMPLES / 'student_ik.py'}:in_plane", *ARM],
         "did you mean `in_the_plane`? functions there: ik, "),
        ([f"{EXAMPLES / 'student_ik.py'}:wrapped", *ARM], "for the parameter `angle`"),
        ([f"{EXAMPLES / 'student_ik.py'}:ik", "--robot", "ur3"], "returned 1 x 4 numbers; it must "
         "return 6 joint positions"),
        ([f"{EXAMPLES / 'student_ik.py'}:ik", "--robot", "ur33"], "'ur33' is not known"),
        ([f"{EXAMPLES / 'student_ik.py'}:ik", *ARM, "--link", "hand"], "no link 'hand'"),
    ],
)  # fmt: skip
def test_wrong_usage_is_reported_with_exit_code_2(
    tmp_path, monkeypatch, capfd, arguments, reported
):
    monkeypatch.chdir(tmp_path)
    assert main(["ik-test", *arguments]) == 2
    said = capfd.readouterr()
    assert reported in said.err
    assert said.out == ""
    assert list(tmp_path.iterdir()) == []
