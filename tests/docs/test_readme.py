"""What the README shows is what is there."""

import re
import shlex
from pathlib import Path

import cv2
import pytest

from docs import ROOT
from docs.generators import gallery
from docs.generators.readme_samples import refusal
from harness.cli.main import main

README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = (ROOT / "docs/reference/commands.md").read_text(encoding="utf-8")
SHOWING = [ROOT / "docs/guides/reports.md", ROOT / "docs/gallery.md"]


def blocks(language):
    return re.findall(rf"(?ms)^```{language}\n(.*?)^```$", README)


def test_the_scenario_shown_is_the_file_named_above_it():
    [shown] = blocks("yaml")
    named = re.findall(r"`(scenarios/\S+\.scenario\.yaml)`", README.split(shown)[0])[-1]
    assert shown == (ROOT / named).read_text(encoding="utf-8")


def test_the_pictures_are_there_and_small():
    first, page = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", README)
    assert (ROOT / first).stat().st_size < 200_000
    assert cv2.imread(str(ROOT / first)).shape == (480, 640, 3)
    assert ROOT / page == gallery.FOLDER / f"{gallery.PAGE[0]}.png"


def test_the_order_is_picture_commands_scenario_report_links():
    marks = ["![", "## Two commands", "```yaml", "gallery/page.png", "$ harness run"]
    marks += ["```sh\npytest", "harness ik-test", "## More to read"]
    places = [README.index(mark) for mark in marks]
    assert places == sorted(places)


def test_the_gallery_shows_every_lesson_and_the_page_and_says_how_it_was_made():
    said = "".join(page.read_text(encoding="utf-8") for page in SHOWING)
    pictures = {
        Path(name).stem
        for name in re.findall(r"!\[[^\]]+\]\(((?:\.\./)?pictures/gallery/[^)]+)\)", said)
    }
    lessons = {file.name.split(".")[0] for file in (ROOT / "scenarios/lessons").glob("*.yaml")}
    assert pictures == {*lessons, "page"} == {*gallery.SHOWN, gallery.PAGE[0]}
    assert {file.stem for file in gallery.FOLDER.glob("*.png")} == pictures
    assert all(file.stat().st_size < 400_000 for file in gallery.FOLDER.glob("*.png"))
    assert f"`{gallery.RENEW}`" in said


def test_the_command_table_is_what_the_program_offers(capsys):
    with pytest.raises(SystemExit):
        main(["--help"])
    offered = re.findall(r"(?m)^    ([\w-]+) +\w+", capsys.readouterr().out)
    assert sorted(re.findall(r"(?m)^\| `harness ([\w-]+)", COMMANDS)) == sorted(offered)


def test_the_command_table_lists_every_kind_of_list():
    from harness.cli.commands.list import LISTINGS

    row = re.search(r"(?m)^\| `harness list KIND` \|(.*)$", COMMANDS)[1]
    assert re.findall(r"`([\w-]+)`", row) == [*LISTINGS]


def test_the_guide_names_every_command_that_loads_plug_ins(capsys):
    guide = (ROOT / "docs/guides/python.md").read_text(encoding="utf-8")
    named = re.search(r"--plugin remarks.py` \(in (.*?);", guide, re.S)[1]
    loading = []
    for command in re.findall(r"(?m)^\| `harness ([\w-]+)", COMMANDS):
        with pytest.raises(SystemExit):
            main([command, "--help"])
        loading += [command] * ("--plugin" in capsys.readouterr().out)
    assert re.findall(r"`([\w-]+)`", named) == loading


def test_options_named_in_the_command_table_exist(capsys):
    for command, text in re.findall(r"(?m)^\| `harness ([\w-]+).*?\| (.*) \|$", COMMANDS):
        with pytest.raises(SystemExit):
            main([command, "--help"])
        said = capsys.readouterr().out
        for option in re.findall(r"`(--?[a-z][a-z-]*)", text):
            assert option in said, f"harness {command} has no {option}"


def test_files_named_in_commands_exist():
    for line in "".join(blocks("sh")).splitlines():
        for word in shlex.split(line, comments=True):
            if word.startswith("scenarios/"):
                assert (ROOT / word.partition(":")[0]).exists(), word


def test_every_lesson_has_its_line():
    lessons = ROOT / "scenarios/lessons"
    reported = re.findall(r"\]\(([^)/]+\.scenario\.yaml)\)", (lessons / "README.md").read_text())
    assert reported == sorted(path.name for path in Path(lessons).glob("*.scenario.yaml"))


def test_the_sample_of_a_refused_file_names_each_mistake():
    said = refusal()
    assert said in COMMANDS
    assert "did you mean `mogi_home`?" in said
    assert "no verb is called `grip`" in said
    assert "`5 kg` is a mass" in said
