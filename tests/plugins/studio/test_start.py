"""`harness studio ROBOT`: the scenario that the studio begins with."""

import argparse

import pytest

from harness.plugins.studio.commands import studio
from harness.plugins.studio.document import Document
from harness.plugins.studio.files import StudioFiles
from harness.plugins.studio.live_cell import LiveCell
from harness.suite.discovery import UsageError


def begun(*words):
    """The text of the scenario that the command line begins with."""
    parser = argparse.ArgumentParser()
    studio.StudioCommand().add_options(parser)
    return studio.start_of(parser.parse_args(words))[1]


def test_a_base_stands_where_the_command_line_puts_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = begun("ur3e", "--world", "lesson_ur", "--base", "0", "-0.25", "1.02")
    cell = LiveCell(StudioFiles(tmp_path, tmp_path / "new.scenario.yaml"), Document(text))
    base = cell.cell.frame(cell.description.base_link)
    assert base.translation.tolist() == [0, -0.25, 1.02]


@pytest.mark.parametrize("words", [["0", "0"], ["0", "0", "high"], ["0", "0", "nan"]])
def test_a_base_that_is_no_place_is_refused(words, capsys):
    with pytest.raises(SystemExit):
        begun("ur3e", "--base", *words)
    assert "--base" in capsys.readouterr().err


def test_a_scenario_has_its_own_base():
    with pytest.raises(UsageError, match="--base are for a robot"):
        begun("01_open_manipulator_first_steps", "--base", "0", "0", "1")


@pytest.mark.parametrize(
    "words", [("--world", "lesson_ur"), ("--gripper", "rh_p12_rn_a"), ("--base", "0", "0", "1")]
)
def test_saved_work_is_not_opened_as_if_it_had_the_options(tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    saved = tmp_path / "ur3e_by_hand.scenario.yaml"
    saved.write_text(begun("ur3e"))
    with pytest.raises(UsageError, match=r"'ur3e_by_hand\.scenario\.yaml' exists"):
        begun("ur3e", *words)
    assert begun("ur3e") == saved.read_text()
