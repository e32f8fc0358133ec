"""What people read is plain technical English: known words, and descriptions that stand alone."""

import ast
import json
import re
from functools import cache

import pytest

from docs import ROOT
from harness.cli.main import main
from harness.plugins.authoring.scenario_schema import schema_text, world_schema_text
from harness.robot.robot_yaml import RobotYaml

INSTEAD = {
    "told|tells?|telling": "report, show, print or log",
    "asks?|asked|asking": "request, require or query",
    "wanted|wants?": "required, requested or expected",
    "meant": "intended or expected",
    "beside": "next to, adjacent to or alongside",
    "behind": "after or distal to (of space: name it in SPATIAL)",
    "came to|comes? to|coming to": "result in, become or contain",
    "falls? to|fell to": "be rejected by",
    "nobody": "no user, no step, or the passive voice",
    "speaks? (?:of|for|against)": "name, cover, refer to or count against",
    "spoilt|spoils?": "corrupted or perturbed",
    "mended|mends?": "repaired or recovered",
    "tak(?:e|es|en|ing) up": "held, attached or loaded",
    "carr(?:y|ies|ied) along": "attached to or held by",
    "of ours|of our own|as ours|is ours|and ours": "built-in or bundled",
    "other people's": "third-party",
    "no more than so much": "at most",
}
"""Words that `docs/` and the code avoid, and what to write instead."""

SPATIAL = "the camera|a wall|its back|its normal|its set point|the box|it, each motion"
ALLOWED = re.compile(
    rf"behind (?:{SPATIAL})|lag.*behind|comes? to rest|\.tell\(\)|optimiser\.(?:ask|tell)\(|"
    r"[\"']asked(?: joint positions)?[\"']"
)
"""Spatial `behind`, `lags behind`, `come to rest`, `tell()` of files and cmaes, `ik_test.json`."""

LIKELY = re.compile("|".join(INSTEAD))
"""What a text in small letters has where it has a word; much faster than the words themselves."""

WORD = re.compile(rf"(?<![A-Za-z])(?:{'|'.join(INSTEAD)})(?![A-Za-z])", re.IGNORECASE)
FOLDERS = ("harness", "tests", "docs", "scenarios", "robots", "worlds")
SUFFIXES = {".py", ".js", ".css", ".html", ".md", ".yaml", ".toml"}
SECTIONS = ("Args", "Attributes", "Returns", "Yields")
FRAGMENT = re.compile(
    "(?:Of|That|Which|Whose|By|From|In|As|For|To|On|At|About|Not|Below|Before|Shape) "
)

NO_SUBJECT = re.compile("(?:Of|That|Whose|To|About|Not|Below|Before|Shape|By) ")
"""How a docstring begins that makes no sense without the name."""


def texts():
    """Each text file of the repository that people read, with its path."""
    files = [*ROOT.glob("*.md"), ROOT / "pyproject.toml", ROOT / "reports/README.md"]
    files += [path for name in FOLDERS for path in (ROOT / name).rglob("*")]
    for path in sorted(files):
        name = path.relative_to(ROOT).as_posix()
        if path.suffix in SUFFIXES and path.is_file() and not name.endswith("test_prose.py"):
            yield name, path.read_text(encoding="utf-8")


def advice(word):
    """What to write instead of a word."""
    plain = re.sub(r"[_\s]+", " ", word).lower()
    return next(text for words, text in INSTEAD.items() if re.fullmatch(words, plain))


def dialect(name, text):
    """A message for each word of a text that has a plainer one; names are split into words."""
    text = re.sub(r"(?<=[a-z])(?=[A-Z])|_+", " ", text)
    if not LIKELY.search(text.lower()):
        return
    for number, line in enumerate(text.splitlines(), 1):
        for word in WORD.findall(ALLOWED.sub("", line)) if WORD.search(line) else ():
            yield f"{name}:{number}: '{word}': write {advice(word)}"


def flaw(text):
    """What keeps a description from standing alone; None where nothing does."""
    if not re.match(r"[A-Z0-9`(\"'$]", text):
        return "begin with a capital letter or with code"
    if not text.endswith((".", ".)")):
        return "end with a period"
    if FRAGMENT.match(text):
        return f"name the subject: 'The ... {text.split()[0].lower()} ...'"
    if len(text.split()) < 4:
        return "write at least four words that make sense without the name"
    return None


def described(node):
    """Line and text of each entry under Args, Attributes, Returns and Yields of a docstring."""
    entries, section, is_first = [], "", False
    lines = (ast.get_docstring(node) or "").splitlines()
    for number, line in enumerate(lines, node.body[0].lineno):
        if heading := re.fullmatch(r"([A-Z][a-z]+):", line):
            section, is_first = heading[1], True
        elif section in ("Args", "Attributes") and re.match(r" {4}\S", line):
            entries.append([number, line.partition(":")[2]])
        elif section in ("Returns", "Yields") and is_first:
            entries.append([number, line])
            is_first = False
        elif section in SECTIONS and line.startswith(" "):
            entries[-1][1] += line
        elif line.strip():
            section = ""
    return [(number, " ".join(text.split())) for number, text in entries]


def test_no_text_has_a_word_of_the_dialect():
    found = [each for item in texts() for each in dialect(*item)]
    assert not found, "\n".join(found)


def test_help_has_no_word_of_the_dialect(capsys):
    with pytest.raises(SystemExit):
        main(["--help"])
    commands = re.findall(r"(?m)^    ([a-z-]+) {2,}", capsys.readouterr().out)
    assert {"run", "check", "bench"} <= {*commands}
    for command in commands:
        with pytest.raises(SystemExit):
            main([command, "--help"])
    text = re.sub(r"\s+", " ", capsys.readouterr().out)
    assert not list(dialect("help", text))


def robot_yaml_schema():
    return json.dumps(RobotYaml.model_json_schema())


@pytest.mark.parametrize("text", [schema_text, world_schema_text, robot_yaml_schema])
def test_every_description_in_the_schema_stands_alone(text):
    found = []

    def visit(value, path):
        if isinstance(value, list):
            value = dict(enumerate(value))
        for key, entry in value.items() if isinstance(value, dict) else ():
            if key == "description" and isinstance(entry, str):
                first = entry.split("\n\n")[0]
                found.extend(
                    f"{path}: '{part}': {reason}"
                    for part in {first, entry}
                    if (reason := flaw(part))
                )
            visit(entry, f"{path}/{key}")

    visit(json.loads(text()), text.__name__)
    assert not found, "\n".join(found)


@cache
def documented():
    """Every module, class and function of the package, with its file."""
    return [
        (path.relative_to(ROOT).as_posix(), node)
        for path in sorted((ROOT / "harness").rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
    ]


def test_every_argument_attribute_and_result_is_described():
    found, count = [], 0
    for name, node in documented():
        if not isinstance(node, ast.Module):
            for line, entry in described(node):
                count += 1
                if reason := flaw(entry):
                    found.append(f"{name}:{line}: '{entry}': {reason}")
    assert not found, "\n".join(found)
    assert count > 1500


def test_every_docstring_names_its_subject():
    found = [
        f"{name}: '{text}'"
        for name, node in documented()
        if NO_SUBJECT.match(text := (ast.get_docstring(node) or "").partition("\n")[0])
    ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    ("line", "word"),
    [
        ("TOLD_AS_THEY_ARE = 1", "TOLD"),
        ("def isWanted():", "Wanted"),
        ("def what_comes_to():", "comes to"),
        ('"""The planner was asked for a path."""', "asked"),
        ("the arm behind the flange", "behind"),
    ],
)
def test_the_check_finds_words_in_names_and_sentences(line, word):
    [message] = dialect("file.py", line)
    assert message.startswith(f"file.py:1: '{word}': write ")


@pytest.mark.parametrize(
    "line", ["the box is behind the camera", "it lags 0.1 rad behind", "beforehand", "tasks"]
)
def test_the_check_passes_over_spatial_and_other_words(line):
    assert not list(dialect("file.py", line))


@pytest.mark.parametrize(
    "text", ["Of a graded scenario.", "Requirements.", "in rad", "The limit of the joint"]
)
def test_the_check_finds_fragments(text):
    assert flaw(text)
