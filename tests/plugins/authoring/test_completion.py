import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from harness.cli.main import main
from harness.core.registry import registry
from harness.plugins.authoring.commands.completion import SCRIPTS
from harness.suite.discovery import bundled_scenarios

BINARIES = Path(sys.executable).parent


def words(capsys, *given):
    assert main(["completion", "--for-words", *given]) == 0
    return capsys.readouterr().out.split()


def test_without_a_shell_the_shells_are_named(capsys):
    assert main(["completion"]) == 2
    assert capsys.readouterr().err == "harness: name a shell: bash, zsh, fish\n"


def test_the_first_word_is_a_command(capsys):
    assert words(capsys, "") == [*registry("command")]
    assert words(capsys, "ch") == ["check"]


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        (["run", "--form"], ["--format"]),
        (["run", "--format", ""], ["full", "short", "json", "github"]),
        (["list", "s"], ["scenarios", "steps"]),
        (["robot", ""], ["check", "show"]),
        (["robot", "check", "--write"], ["--write-srdf"]),
        (["nothing", "x"], []),
    ],
)
def test_options_choices_and_commands_of_commands_follow(
    given, expected, capsys, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    assert words(capsys, *given) == expected


def test_scenarios_are_bundled_names_and_paths(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lessons_of_mine").mkdir()
    (tmp_path / "less[1].scenario.yaml").touch()
    bundled = [name for name in bundled_scenarios() if name.startswith("less")]
    found = words(capsys, "check", "less")
    assert sorted(found) == sorted([*bundled, "lessons_of_mine/", "less[1].scenario.yaml"])
    assert words(capsys, "check", "less[") == ["less[1].scenario.yaml"]


def test_bash_completes_with_the_printed_code(tmp_path):
    script = (
        'eval "$(harness completion bash)"; COMP_WORDS=(harness run --form); COMP_CWORD=2; '
        'compopt() { :; }; _harness; echo "${COMPREPLY[@]}"; complete -p harness'
    )
    assert complete("bash", script, tmp_path) == [
        "--format",
        "complete -o default -F _harness harness",
    ]


def test_fish_completes_with_the_printed_code(tmp_path):
    script = "harness completion fish | source; complete -C 'harness run --form'"
    assert complete("fish", script, tmp_path)[0].split()[0] == "--format"


def test_zsh_completes_with_the_printed_code(tmp_path):
    script = (
        'compdef() { :; }; compadd() { echo "$@"; }; eval "$(harness completion zsh)"; '
        "words=(harness run --form); CURRENT=3; _harness"
    )
    assert complete("zsh", script, tmp_path) == ["-- --format"]


def complete(shell, script, folder):
    """Lines that a shell prints, with this `harness` and no file of a user."""
    assert shell in SCRIPTS
    program = shutil.which(shell)
    if program is None:
        pytest.skip(f"there is no {shell} here")
    path = f"{BINARIES}{os.pathsep}{os.environ['PATH']}"
    env = {**os.environ, "PATH": path, "HOME": str(folder)}
    done = subprocess.run(
        [program, "-c", script], env=env, capture_output=True, text=True, check=True
    )
    return done.stdout.splitlines()
