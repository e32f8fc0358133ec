"""The skill for language models is short, complete, and in the package."""

from pathlib import Path

import yaml

import harness
from harness.cli.main import main
from harness.core.registry import registry

SKILL = Path(harness.__file__).parent / "plugins/agents/SKILL.md"


def test_the_command_prints_the_skill_and_its_path(capsys):
    assert main(["skill"]) == 0
    text = SKILL.read_text(encoding="utf-8")
    assert capsys.readouterr().out == text
    assert main(["skill", "--path"]) == 0
    assert Path(capsys.readouterr().out.strip()).read_text(encoding="utf-8") == text


def test_the_skill_has_the_form_that_programs_read():
    text = SKILL.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 60
    _, head, body = text.split("---\n", 2)
    fields = yaml.safe_load(head)
    assert fields["name"] == "armharness"
    assert 50 < len(fields["description"]) < 1024
    assert "harness describe" in body
    assert {"describe", "skill"} <= {*registry("command")}
