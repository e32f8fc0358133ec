"""Packages whose plug-ins are wrong: one line each, and the rest works."""

import pytest

from tests.plugins.commands import harness

HEAD = "from harness.cli.command import Command\n\n\nclass Margins(Command):\n"
BODY = (
    "    name = 'margins'\n    def add_options(self, command): pass\n"
    "    def run(self, arguments): return {}\n"
)
DOCSTRING = '    """Print margins."""\n'


def site_of(folder, code):
    """A folder of installed packages with one that has this module."""
    folder.mkdir()
    (folder / "acme_arm.py").write_text(code, encoding="utf-8")
    info = folder / "acme_arm-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: acme-arm\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[harness.plugins]\narm = acme_arm\n")
    return folder


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize(
    ("code", "reason"),
    [
        (HEAD + BODY.format("0"), "the command `margins` has no docstring"),
        ("def (", "SyntaxError"),
        ("import absent_library", "absent_library"),
    ],
)
def test_the_help_names_a_package_that_is_wrong_and_lists_the_rest(tmp_path, code, reason):
    site = site_of(tmp_path / "site", code)
    shown = harness(tmp_path, "--help", site=site)
    assert reason in shown
    assert "acme" in shown
    assert "run scenarios and judge them" in shown
    assert "Traceback" not in shown
    unknown = harness(tmp_path, "margins", site=site, code=2)
    assert reason in unknown
    assert "Traceback" not in unknown


def test_a_command_without_an_exit_code_is_an_error_of_its_package(tmp_path):
    site = site_of(tmp_path / "site", HEAD + DOCSTRING + BODY.format("None"))
    shown = harness(tmp_path, "margins", site=site, code=3)
    assert "`margins` of acme_arm returned None, which is no exit code" in shown
