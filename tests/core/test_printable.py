import json
import os
import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.printable import (
    ESC,
    columns_of,
    cropped,
    fitted,
    json_printable,
    printable,
    printable_lines,
    terminal_text,
)

ACTS = {
    "a colour": ("\x1b[31m", r"\x1b[31m"),
    "a title by OSC": ("\x1b]0;x\x07", r"\x1b]0;x\x07"),
    "C1 CSI": ("\x9b31m", r"\x9b31m"),
    "a line end": ("a\nb\r\x85\u2028", r"a\nb\r\x85\u2028"),
    "a bidi override": ("\u202eb\u2066", r"\u202eb\u2066"),
    "half a character": ("\udcff", r"\udcff"),
    "a tag": ("\U000e0041", r"\U000e0041"),
}


@pytest.mark.parametrize(("text", "shown"), ACTS.values(), ids=ACTS)
def test_what_acts_on_a_terminal_is_shown_as_an_escape(text, shown):
    assert printable(text) == shown
    assert terminal_text(text) == shown


def test_letters_of_any_script_stay_as_they_are():
    text = "ramię über 漢字 العربية 🤖\u200d e\u0301 \\ tab-free"
    assert printable(text) == text


@given(st.text())
def test_nothing_that_acts_is_left_and_a_second_time_changes_nothing(text):
    shown = printable(text)
    assert printable(shown) == shown
    assert not [c for c in shown if unicodedata.category(c) in ("Cc", "Zl", "Zp", "Cs")]
    assert not set(shown) & set("\u061c\u200e\u200f\u202a\u202e\u2066\u2069")
    shown.encode("utf-8")
    assert "\x1b" not in terminal_text(text)


@pytest.mark.parametrize(
    "line",
    ["::warning::x", "  ::error file=a::x", "\t::stop-commands::x", "a ##[error]x",
     "##vso[task.setvariable]x", "x ##teamcity[buildStop]"],
)  # fmt: skip
def test_no_line_is_a_command_of_a_ci_service(line):
    shown = terminal_text(line)
    assert not shown.lstrip().startswith("::")
    assert not {"##[", "##vso[", "##teamcity["} & {shown[i : i + n] for n in (3, 6, 11)
                                                  for i in range(len(shown))}  # fmt: skip


def test_only_the_escape_character_of_this_process_becomes_one():
    assert terminal_text(f"{ESC}[1mx{ESC}[0m") == "\x1b[1mx\x1b[0m"
    other = f"\x1b{os.urandom(8).hex()}[1mx"
    assert "\x1b" not in terminal_text(other)


def test_lines_are_kept_where_a_text_has_several():
    assert printable_lines("a\r\n\tb\x07\nc") == "a\n    b\\x07\nc"


@given(st.dictionaries(st.text(), st.text()))
def test_json_keeps_its_meaning(document):
    text = json.dumps(document, indent=1, ensure_ascii=False)
    shown = json_printable(text)
    assert json.loads(shown) == document
    assert printable_lines(shown) == shown


@given(st.text(alphabet="ab漢 \u0301", max_size=200), st.integers(10, 100))
def test_a_line_is_broken_at_spaces_to_fit_and_loses_no_word(line, columns):
    parts = fitted(printable(line), columns)
    assert " ".join(parts).split() == line.split()
    for part in parts:
        assert columns_of(part) <= columns or " " not in part.strip()


def test_colours_take_no_room_and_a_command_goes_on_after_a_backslash():
    assert columns_of(f"{ESC}[31mab{ESC}[0m") == 2
    assert columns_of(f"{ESC}]8;;file:///x{ESC}\\ab{ESC}]8;;{ESC}\\") == 2
    assert fitted("  again:  run a b", 16, " \\") == ["  again:  run \\", "      a b"]


@given(st.text(alphabet="ab漢", max_size=100), st.integers(12, 60))
def test_a_cropped_line_fits_and_keeps_its_end(line, columns):
    shown = cropped(line, columns)
    assert columns_of(shown) <= columns
    if columns_of(line) > columns:
        assert shown.endswith(line[-4:])
