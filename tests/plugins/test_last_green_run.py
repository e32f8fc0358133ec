"""A run that fails next to the last one that passed: the reporter `green`."""

from pathlib import Path

import pytest

from harness.cli.main import main

TEXT = """\
scenario: still
robot: open_manipulator_x
params:
  duration: 0.1
parametrize:
  duration: [0.1, 0.2]
steps:
  - wait: ${duration}
expect:
  - duration: {at_most: 0.3 s}
"""
PAGE = "against_last_green.html"
FILE = Path("still.scenario.yaml")


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    FILE.write_text(TEXT)


def run(*options):
    return main(["run", str(FILE), "--in-process", "--no-page", *options])


def pages():
    return sorted(page.parent.name for page in Path("reports").rglob(PAGE))


def test_each_case_that_fails_is_compared_with_its_own_last_passed_run(capsys):
    assert run("--reporter", "green=kept") == 0
    assert not pages()
    kept = sorted(Path("kept").rglob("run.json"))
    assert len(kept) == 2
    FILE.write_text(TEXT.replace("0.3 s", "0.15 s"))
    assert run("--reporter", "green=kept") == 1
    [case] = pages()
    assert "0.2" in case
    text = next(Path("reports").rglob(PAGE)).read_text()
    assert "last green run" in text
    assert "at_most: 0.15 s" in text
    assert f"{case}/{PAGE}" in capsys.readouterr().out


@pytest.mark.nightly
def test_without_an_earlier_run_there_is_no_page():
    FILE.write_text(TEXT.replace("0.3 s", "0.05 s"))
    assert run("--reporter", "green=kept") == 1
    assert not pages()
    assert not list(Path("kept").rglob("run.json"))


@pytest.mark.parametrize(
    ("option", "words"),
    [
        ("green", "--reporter: the reporter `green` needs a folder: green=DIR"),
        ("green=", "needs a folder: green=DIR"),
        ("green=reports", "choose another folder"),
        ("green=./kept/../reports", "choose another folder"),
        ("green=still.scenario.yaml", "is no folder"),
        ("green=still.scenario.yaml/below", "is no folder"),
        ("html=kept", "the reporter `html` takes no text after its name"),
    ],
)
def test_a_folder_that_is_not_the_one_of_reports_is_needed_before_anything_runs(
    option, words, capsys
):
    assert run("--reporter", option) == 2
    assert words in capsys.readouterr().err
    assert not Path("reports").exists()


def test_a_name_that_does_not_exist_is_refused_before_anything_runs(capsys):
    assert run("--reporter", "gren=kept") == 2
    assert "did you mean `green`?" in capsys.readouterr().err
    assert not Path("reports").exists()
