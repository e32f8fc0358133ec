"""The check of motions in C is compiled when the package is built, and loaded where it fits."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from harness.core.errors import HarnessError
from harness.planning.collision.native import build, library, sources

NATIVE = sources.FOLDER


@pytest.fixture
def copy(tmp_path):
    """The sources in another folder, without a library."""
    ignored = shutil.ignore_patterns("*.so", "__pycache__")
    return Path(shutil.copytree(NATIVE, tmp_path / "native", ignore=ignored))


def compiled(folder: Path) -> Path:
    done = subprocess.run(
        [sys.executable, str(folder / "build.py")], check=True, capture_output=True, text=True
    )
    return Path(done.stdout.strip())


def test_a_tree_that_was_never_compiled_names_the_command(copy, monkeypatch):
    monkeypatch.setattr(sources, "FOLDER", copy)
    with pytest.raises(HarnessError, match="run `python harness/planning/collision/native/build"):
        library.library.__wrapped__()


@pytest.mark.nightly
def test_other_sources_get_a_library_of_another_name_which_replaces_the_old_one(copy):
    first = compiled(copy)
    assert first.name == sources.library_path().name
    (copy / "certify.c").write_text((copy / "certify.c").read_text() + "/* changed */\n")
    second = compiled(copy)
    assert second.name != first.name
    assert [*copy.glob("*.so")] == [second]


@pytest.mark.nightly
def test_sources_that_do_not_compile_leave_no_half_written_library(copy):
    first = compiled(copy)
    (copy / "certify.c").write_text("int certify(;\n")
    with pytest.raises(subprocess.CalledProcessError):
        compiled(copy)
    assert [*copy.glob("*.so")] == [first]


@pytest.mark.nightly
def test_every_file_of_the_sources_belongs_to_the_name(copy):
    names = {compiled(copy).name}
    for file in sorted([*copy.glob("*.h"), *copy.glob("*.c")]):
        with file.open("a") as stream:
            stream.write("/* changed */\n")
        names.add(compiled(copy).name)
    assert len(names) == 1 + len([*copy.glob("*.h"), *copy.glob("*.c")])


def test_the_compiler_of_the_variable_cc_comes_first(monkeypatch):
    monkeypatch.setenv("CC", "ccache gcc")
    assert build.system_compiler() == ["ccache", "gcc"]


def test_without_a_compiler_the_build_requires_zig(monkeypatch, tmp_path):
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert build.system_compiler() is None
    hook = build.NativeCheck(str(tmp_path), {}, None, None, "", "wheel")
    assert hook.dependencies() == ["ziglang"]
