from harness.core.errors import Problem, SpecError


def test_problems_are_in_file_order_whatever_order_they_are_found_in():
    late, early = Problem("a.yaml", 9, 1, "late"), Problem("a.yaml", 2, 7, "early")
    assert [p.message for p in SpecError([late, early]).problems] == ["early", "late"]


def test_a_problem_of_the_whole_file_has_no_line():
    assert str(Problem("a.yaml", 0, 0, "the file is empty")) == "a.yaml: the file is empty"
    assert str(Problem("a.yaml", 0, 0, "empty", "write one")) == "a.yaml: empty\n  write one"


def test_the_caret_stands_under_the_place():
    problem = Problem(
        "a.yaml", 14, 12, "no group `amr`", "did you mean `arm`?", "    group: amr", 3
    )
    assert str(problem).splitlines() == [
        "a.yaml:14:12: no group `amr`",
        "   14 |     group: amr",
        "      |            ^^^ did you mean `arm`?",
    ]


def test_the_caret_stands_under_the_place_after_tabs_and_wide_characters():
    lines = str(Problem("a.yaml", 1, 4, "x", "", "\t日本x", 1)).splitlines()
    assert lines[1] == "    1 |     日本x"
    assert lines[2] == "      |         ^"


def test_a_long_line_is_cut_around_the_place():
    line = "a" * 500 + "HERE" + "b" * 500
    text = str(Problem("a.yaml", 3, 501, "x", "", line, 4))
    excerpt, caret = text.splitlines()[1:3]
    start = caret.index("^")
    assert excerpt[start : start + 4] == "HERE"
    assert len(excerpt) < 130


def test_a_long_hint_is_wrapped_under_the_caret():
    problem = Problem("a.yaml", 1, 1, "x", "words: " + ", ".join(["alpha"] * 60), "x: 1", 1)
    lines = str(problem).splitlines()
    assert all(len(line) < 130 for line in lines)
    assert lines[2] == "      | ^"
    assert lines[3].startswith("      | words: alpha")
