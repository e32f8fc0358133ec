"""Names that try to act on a terminal, a CI service or a reader, in every place of a user's."""

import io
import json
import os
import re
import subprocess
import sys
import unicodedata
from contextlib import chdir, redirect_stderr, redirect_stdout
from xml.etree import ElementTree

import pytest
import yaml

from harness.cli.main import main
from tests.cli.run_in_terminal import STYLING, run_in_terminal

RUN = ["run", "a.scenario.yaml", "--no-report", "--in-process"]
NAMES = {
    "a terminal": "\x1b[31m\x1b]0;FORGED\x07\x9b31m\u202eFORGED\u2066\x1b[2K\x7f\ufeff\U000e0041",
    "a log": "\n::warning::FORGED\nFORGED ##[error]y ##vso[task.complete]\r::error::F%0A::error::F",
    "a reader": "x\r\nFORGED\x85FORGED\u2028FORGED [[ATTACHMENT|/etc/passwd]]\n\nFORGED\u2029",
    "all of them": "\x1b[31m\x1b]0;F\x07\x9b31m\u202e\u2066\x7f\ufeff\U000e0041"
    "\n::error::F\nFORGED##[e]##vso[t]\r::error::F\x85FORGED\u2028FORGED\u2029[[ATTACHMENT|",
}
DIRECTIONS = "\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069\ufeff"


def scenario(name, **more):
    """A scenario that fails, with the name wherever one may stand."""
    return yaml.safe_dump({
        "scenario": name,
        "description": name,
        "tags": ["hostile"],
        "verifies": [name],
        "robot": "open_manipulator_x",
        "seed": 1,
        "objects": [{"name": name, "static": True, "box": {"size": [0.05, 0.05, 0.05]},
                     "pose": {"xyz": [0.3, 0.2, 0.025]}}],
        "cameras": [{"name": name, "pose": {"xyz": [0.3, 0, 0.7]}, "look_at": [0.2, 0.001, 0],
                     "image": {"width": 64, "height": 48}}],
        "steps": [{"wait": "0.1 s", "id": name}, {"capture": {"camera": name}},
                  {"move_to": {"pose": {"xyz": [3, 0, 0]}}, "id": f"{name}2"}],
        "expect": [{"static": {"object": name}}, {"duration": {"at_least": "9 s"}},
                   {"sees": {"camera": name, "object": name}}],
        **more,
    })  # fmt: skip


def harmless(text, commands=0):
    """Check that nothing in a text acts or is forged; `commands` of GitHub's are the program's."""
    lines = text.replace("\r\n", "\n").split("\n")
    for line in lines:
        acting = [c for c in line if unicodedata.category(c) in ("Cc", "Cs", "Zl", "Zp")]
        assert not acting, ascii(line)
        assert not set(line) & set(DIRECTIONS), ascii(line)
        assert "\U000e0041" not in line, ascii(line)
        assert not line.startswith("FORGED"), ascii(line)
        assert "##[" not in line, ascii(line)
        assert "##vso[" not in line, ascii(line)
    found = [line for line in lines if line.lstrip().startswith("::")]
    assert len(found) == commands, found
    assert all(re.fullmatch(r"::error [^\x1b\n]*::[^\x1b\n]*", line) for line in found), found
    return text


def command(folder, *arguments, commands=0):
    """What a command writes, harmless; it runs in this process, which is faster."""
    out, err = io.StringIO(), io.StringIO()
    with chdir(folder), redirect_stdout(out), redirect_stderr(err):
        main([*map(str, arguments)])
    assert "Traceback" not in err.getvalue(), err.getvalue()
    harmless(err.getvalue())
    return harmless(out.getvalue(), commands)


IN_DEFAULT_RUN = pytest.mark.nightly(but=["all of them"])
"""The name that tries everything represents the others."""


@pytest.fixture(scope="module", params=NAMES.values(), ids=NAMES)
def hostile(request, tmp_path_factory):
    """A folder with a hostile scenario, and its run."""
    folder = tmp_path_factory.mktemp("hostile")
    (folder / "a.scenario.yaml").write_text(scenario(request.param), encoding="utf-8")
    said = command(folder, "run", "a.scenario.yaml", "--in-process")
    assert "NO_IK_SOLUTION" in said, said
    return folder


COMMANDS = [
    [*RUN, "--format", "short"],
    [*RUN, "--repeat", "2"],
    [*RUN, "--json"],
    ["check", "a.scenario.yaml"],
    ["check", "a.scenario.yaml", "--format", "short"],
    ["check", "a.scenario.yaml", "--json"],
    ["explain", "a.scenario.yaml"],
    ["judge", "reports/a"],
    ["judge", "reports/a", "--contacts"],
    ["judge", "reports/a", "--json"],
    ["compare", "reports/a", "reports/a"],
    ["compare", "reports/a", "reports/a", "--json"],
    ["view", "reports/a", "--no-open"],
]


@pytest.mark.nightly(but=[f"all of them-{' '.join(words)}" for words in COMMANDS])
@pytest.mark.parametrize("arguments", COMMANDS, ids=" ".join)
def test_no_command_prints_what_acts(hostile, arguments):
    command(hostile, *arguments)


@pytest.mark.nightly(but=["all of them-run", "all of them-check"])
@pytest.mark.parametrize("verb", ["run", "check"])
def test_annotations_for_github_are_the_programs_alone(hostile, verb):
    arguments = RUN if verb == "run" else ["check", "a.scenario.yaml"]
    command(hostile, *arguments, "--format", "github", commands=1)


@IN_DEFAULT_RUN
def test_a_recording_of_a_hostile_run_is_graded_harmlessly(hostile):
    command(hostile, "export", "reports/a", "--bag", "recorded", "--force")
    command(hostile, "grade", "a.scenario.yaml", "recorded")


@IN_DEFAULT_RUN
def test_a_terminal_gets_only_the_programs_own_sequences(hostile):
    session = run_in_terminal(RUN, hostile)
    harmless(STYLING.sub("", session.text).replace("\r\x1b[2K", ""))


@pytest.mark.nightly
@IN_DEFAULT_RUN
def test_the_files_of_a_suite_hold_nothing_that_acts(hostile, tmp_path, monkeypatch):
    for name in ("b", "c"):
        text = (hostile / "a.scenario.yaml").read_text(encoding="utf-8")
        (tmp_path / f"{name}.scenario.yaml").write_text(text, encoding="utf-8")
    summary = tmp_path / "summary.md"
    monkeypatch.setenv("GITHUB_ACTIONS", "true")
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(summary))
    command(tmp_path, "run", ".", "--in-process", commands=2)
    harmless(summary.read_text(encoding="utf-8"))
    for file in ("results.json", "results.jsonl", "junit.xml"):
        harmless((tmp_path / "reports" / file).read_text(encoding="utf-8"))
    results = json.loads((tmp_path / "reports/results.json").read_text())["cases"]
    assert results[0]["title"] == yaml.safe_load(text)["scenario"], "to a machine, the same"
    tree = ElementTree.parse(tmp_path / "reports/junit.xml")
    for element in tree.iter():
        harmless(element.text or "")
        for value in element.attrib.values():
            harmless(value)
    said = "".join(element.text or "" for element in tree.iter("system-out"))
    assert said.count("[[ATTACHMENT|") == 2, "only the program's own"


@pytest.mark.nightly
def test_pytest_prints_nothing_that_acts(hostile):
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-v", "-rA", "-p", "no:cacheprovider", "a.scenario.yaml",
         "--harness-report-dir", "of_pytest", "--junit-xml", "of_pytest.xml"],
        cwd=hostile, capture_output=True, check=False,
        env={**os.environ, "GITHUB_ACTIONS": "true", "CI": "true"},
    )  # fmt: skip
    assert b"1 failed" in done.stdout, done.stdout.decode(errors="replace")
    harmless(done.stdout.decode(), commands=1)


MISTAKES = {
    "unknown key": {"FORGED\n\x1b[31m": 1},
    "unknown step": {"steps": [{"\x9b2J\u202e": 1}]},
    "unknown robot": {"robot": "\x1b]0;x\x07\u202e"},
    "unknown world": {"world": "a\nFORGED\u2066"},
    "unknown object": {"expect": [{"static": {"object": "\x1b[2J\nFORGED"}}]},
    "unknown state": {"steps": [{"move_to": "\x1b[2J\nFORGED\u202e"}]},
    "include": {"include": "\x1b[2J\nFORGED\u202e.yaml"},
    "mesh": {"objects": [{"name": "a", "mesh": {"file": "\x1b[2J\nFORGED.stl"}}]},
}


@pytest.mark.parametrize("change", MISTAKES.values(), ids=MISTAKES)
@pytest.mark.parametrize("form", ["full", "github"])
def test_messages_about_mistakes_are_harmless(tmp_path, change, form):
    (tmp_path / "bad.scenario.yaml").write_text(scenario("plain", **change), encoding="utf-8")
    out = io.StringIO()
    with chdir(tmp_path), redirect_stdout(out):
        assert main(["check", "bad.scenario.yaml", "--format", form]) == 2, out.getvalue()
    said = out.getvalue()
    harmless(said, commands=said.count("::error ") if form == "github" else 0)


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "\x1b[31mFORGED\n::error::x.yaml"],
        ["run", "\x1b[31m\u202e", "-k", "\x1b[31m\nFORGED"],
        ["run", "bundled", "--case", "\x1b[31m\nFORGED"],
        ["check", "\x1b[31m", "--set", "\x1b[31m\nFORGED"],
        ["list", "\x1b[31m\u202e\nFORGED"],
        ["run", "x", "--\x1b[31m\u202e"],
        ["robot", "check", "\x1b[31m\u202e\nFORGED"],
        ["judge", "\x1b[31m\u202e\nFORGED"],
        ["new", "\x1b[31m\u202e\nFORGED.scenario.yml"],
        ["run", b"\xff\xfe\x9b.scenario.yaml"],
    ],
    ids=lambda arguments: arguments[0],
)
def test_messages_about_arguments_are_harmless(tmp_path, arguments):
    out, err = io.StringIO(), io.StringIO()
    with chdir(tmp_path), redirect_stdout(out), redirect_stderr(err):
        try:
            code = main([os.fsdecode(each) for each in arguments])
        except SystemExit as end:  # of argparse
            code = end.code
    assert code == 2
    harmless(out.getvalue())
    harmless(err.getvalue())


@pytest.mark.nightly(but=["\\xff\\xfe"])
@pytest.mark.parametrize("file", ["\x1b[31mFORGED\n::error::x", "\u202eb\u2066", b"\xff\xfe"])
def test_names_of_files_are_harmless(tmp_path, file):
    place = os.path.join(os.fsencode(tmp_path), os.fsencode(file) + b".scenario.yaml")  # noqa: PTH118
    with open(place, "w", encoding="utf-8") as new:  # noqa: PTH123
        new.write(scenario("plain"))
    name = os.fsdecode(place)
    printed = command(tmp_path, "run", name, "--in-process", "--no-page")
    is_text = isinstance(file, str)  # a name that is not UTF-8 is refused
    assert ("NO_IK_SOLUTION" in printed) == is_text
    command(tmp_path, "check", name)
