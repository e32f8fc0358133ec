"""Robots of packages that anyone can install; their page is what is found here."""

from importlib.metadata import distribution
from pathlib import Path

import pytest

from tests.packages.arms import ARMS, OTHERS, PACKAGES, WITH_GRIPPER
from tests.packages.page import PAGE, RENEW, page, pick_row, row, written
from tests.packages.trial import try_arm, try_pick

pytestmark = pytest.mark.needs_packages
SUFFIXES = (".urdf", ".xacro", ".sdf")
AGREEMENT = 1e-9  # [m], [kg]


@pytest.mark.parametrize("arm", ARMS, ids=lambda arm: arm.name)
def test_an_arm_does_what_its_line_of_the_page_says(arm, tmp_path):
    trial = try_arm(arm, tmp_path)
    if trial.joints:
        assert trial.position_difference < AGREEMENT
        assert trial.mass_difference < AGREEMENT
    assert trial.moved or trial.reason
    said = PAGE.read_text(encoding="utf-8")
    assert row(arm, trial) in said.splitlines(), f"renew the page: {RENEW}"


def test_the_page_has_a_line_for_every_arm_and_no_other():
    rows, picks = written()
    assert list(rows) == [arm.name for arm in ARMS]
    assert list(picks) == [arm.name for arm in WITH_GRIPPER]
    assert page(rows, picks) == PAGE.read_text(encoding="utf-8")


@pytest.mark.parametrize("arm", WITH_GRIPPER, ids=lambda arm: arm.name)
def test_a_generated_scenario_picks_a_box_or_the_page_says_why_not(arm, tmp_path):
    trial = try_pick(arm, tmp_path)
    assert trial.picks or trial.reason
    said = PAGE.read_text(encoding="utf-8")
    assert pick_row(arm, trial) in said.splitlines(), f"renew the page: {RENEW}"


@pytest.mark.parametrize("name", PACKAGES)
def test_every_description_in_a_package_is_an_arm_or_said_to_be_none(name):
    folder = Path(str(distribution(name).locate_file(PACKAGES[name].folder)))
    files = {
        path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.suffix in SUFFIXES
    }
    others = tuple(" ".join(OTHERS[name].values()).split())
    arms = {arm.file for arm in ARMS if arm.package == name and arm.kind != "mjcf"}
    assert arms <= files
    assert {file for file in files if not file.startswith(others)} == arms


def test_most_arms_move():
    moved = [line for line in written()[0].values() if "| yes |" in line]
    assert len(moved) >= len(ARMS) - 4
