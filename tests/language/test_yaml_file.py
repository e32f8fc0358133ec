import pytest

from harness.core.errors import SpecError
from harness.core.limits import YAML_FILE
from harness.language.files.source import Source
from harness.language.files.yaml_file import parse_value, parse_yaml, read_text


def parse(text):
    return parse_yaml(text, Source.of_text("f.yaml", text))


def problem_of(text):
    with pytest.raises(SpecError) as caught:
        parse(text)
    assert len(caught.value.problems) == 1
    return caught.value.problems[0]


def test_scalars_are_read_by_the_core_schema_of_yaml_1_2():
    values = parse(
        "v: [on, yes, no, 1e-3, 1e3, 0o17, 0x1F, 12:30, 1_000, 010, -.5, +1, null, ~, true, False]"
    ).plain()["v"]
    assert values == [
        *("on", "yes", "no", 0.001, 1000.0, 15, 31, "12:30", "1_000", 10, -0.5, 1),
        *(None, None, True, False),
    ]
    assert [type(values[index]) for index in (3, 4, 9, 11)] == [float, float, int, int]


def test_quoted_numbers_and_booleans_stay_text():
    assert parse("v: ['1', \"true\", '~', \"1e3\"]").plain() == {"v": ["1", "true", "~", "1e3"]}


def test_keys_are_text_whatever_they_look_like():
    assert parse("{1: a, on: b, true: c, ~: d}").plain() == {
        "1": "a",
        "on": "b",
        "true": "c",
        "~": "d",
    }


def test_every_value_knows_its_line_and_column():
    root = parse('é: "äö"\nlist:\n  - {x: 1, y: [a, b]}\n')
    item = root.mapping()["list"].value.items()[0]
    place = item.mapping()["y"].value.items()[1].place
    assert (place.line, place.column) == (3, 19)
    assert (item.mapping()["x"].key.line, item.mapping()["x"].key.column) == (3, 6)
    assert root.mapping()["é"].value.place.length == 4


def test_an_alias_stands_for_its_anchor():
    assert parse("a: &x {b: [1]}\nc: *x").plain() == {"a": {"b": [1]}, "c": {"b": [1]}}


@pytest.mark.parametrize(
    ("text", "line", "column", "message"),
    [
        ("a: 1\nb: 2\na: 3\n", 3, 1, "the key `a` is here twice"),
        ("a: !!str 5", 1, 4, "`!!str` is a tag"),
        ("a:\n  - !python/name:os.system x", 2, 5, "`!python/name:os.system` is a tag"),
        ("a: .nan", 1, 4, "`.nan` is not a finite number"),
        ("a: [1, -.inf]", 1, 8, "`-.inf` is not a finite number"),
        ("a: 1e999", 1, 4, "`1e999` is not a finite number"),
        ("a: " + "9" * 5000, 1, 4, "is not a finite number"),
        ("b: &b {x: 1}\nc:\n  <<: *b", 3, 3, "merge keys (`<<`)"),
        ("? [a]\n: 1", 1, 3, "a key is text"),
        ("a: 1\n---\nb: 2", 2, 1, "a second begins here"),
        ("\ta: 1", 1, 1, "a tab cannot indent YAML"),
        ("a:\n\t- b", 2, 1, "a tab cannot indent YAML"),
        ("a: b: c", 1, 5, "a second `:` here"),
        ("a: [1, 2\nb: 3\n", 1, 4, "this list is not closed"),
        ("a: 'x\nb: 2\n", 1, 4, "is not closed"),
        ("a: {b: 1\n\n", 1, 4, "this mapping is not closed"),
        ("a: 1\nb: [1,", 2, 7, "a bracket is not closed"),
        ("a: @x", 1, 4, "cannot begin with `@`"),
        ("a: *x", 1, 4, "no complete anchor is called `x`"),
        ("a: &x [*x]", 1, 8, "no complete anchor is called `x`"),
        ("a: 1\nb: \x01", 2, 4, "a control character"),
        ("- a\n- b", 1, 1, "a file is a mapping"),
        ("text", 1, 1, "a file is a mapping"),
        ("", 0, 0, "the file is empty"),
        ("# only a comment\n", 0, 0, "the file is empty"),
        ("---\n...\n", 0, 0, "the file is empty"),
    ],
)
def test_what_is_not_plain_yaml_is_refused_at_its_place(text, line, column, message):
    problem = problem_of(text)
    assert message in problem.message
    assert (problem.line, problem.column) == (line, column)


@pytest.mark.parametrize(
    ("text", "line", "column", "message", "hint"),
    [
        ("a:\n  b 80 g\n  c: 6\n", 2, 3, "this line has none", "`b: 80 g`"),
        ("steps\n  - wait: 1 s\n", 1, 1, "this line has none", "`steps:`"),
        ("a: 1\nsteps\n  - wait: 1 s\nc: 1\n", 2, 1, "this line has none", "`steps:`"),
        ("a: 1\nmass 5 # kg\nb: 2\n", 2, 1, "this line has none", "`mass: 5`"),
        ("s:\n  - pick:box\n    id: x\n", 2, 5, "space is missing after the colon", "`pick: box`"),
        ("a:b\nc: 1\n", 1, 1, "space is missing after the colon", "`a: b`"),
        ("s:\n  - b\n  -c\n  - d\n", 3, 3, "space is missing after the dash", "`- c`"),
        ("s:\n  - x: 1\n  expect: 2\n", 3, 3, "this line has none", "column 5 if"),
        ("s:\n- x: 1\n- y: 1\n z: 2\n", 4, 2, "fits no line above", "column 3 like line 3"),
        ("s:\n  - x: 1\n      id: 2\n", 3, 7, "further than line 2", "column 5"),
        ("a: 1\n  b: 2\n", 2, 3, "further than line 1", "column 1"),
        ("s:\n  x: 1\n  - b: 2\n", 2, 3, "line 3, in the same column", "put `- `"),
        ("o:\n  t:\n    x: 1\n  - n: 2\n", 2, 3, "line 4, in the same column", "put `- `"),
        ("s:\n  - b: 1\n- c: 2\n", 3, 1, "this list item begins in column 1", "3 like line 2"),
        (
            "a:\n    b: 1\n  c: 2\n",
            3,
            3,
            "begins in column 3",
            "column 1 like line 1 or in column 5",
        ),
        ("s: - a\n", 1, 4, "a line of its own", ""),
        ('a: "b" c\n', 1, 8, "has ended", ""),
    ],
)
def test_colons_and_indentation_are_reported_where_the_mistake_is(
    text, line, column, message, hint
):
    problem = problem_of(text)
    assert message in problem.message
    assert hint in (problem.hint or "")
    assert (problem.line, problem.column) == (line, column)


@pytest.mark.parametrize("wrong", ["mass 80 g", "mass:80 g", "steps", "-x"])
def test_following_the_advice_on_a_missing_colon_or_space_gives_yaml(wrong):
    advice = problem_of(f"a: 1\nlist:\n{wrong}\nb: 2\n").hint
    _, right, _ = advice.split("`")
    parse(f"a: 1\nlist:\n{right}\nb: 2\n" if wrong != "-x" else f"a: 1\nlist:\n{right}\n")


def test_a_duplicate_key_names_the_first_ones_line():
    assert problem_of("a: 1\nb: 2\na: 3\n").hint == "the first is in line 1"


def test_several_such_mistakes_are_found_at_once():
    with pytest.raises(SpecError) as caught:
        parse("a: !x 1\nb: .nan\na: 2\n")
    assert [problem.line for problem in caught.value.problems] == [1, 2, 3]


@pytest.mark.parametrize("opening", ["[", "- ", "{a: ", "? "])
def test_a_file_of_brackets_is_refused_and_does_not_end_the_process(opening):
    assert problem_of(opening * 100_000).message == "nested more than 50 levels deep"


def test_aliases_that_multiply_are_bounded():
    lines = ["a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]" for n in range(1, 9)]
    problem = problem_of("\n".join(lines))
    assert problem.message == "more than 100000 values, aliases expanded"
    assert problem.line == 5


def test_aliases_that_deepen_are_bounded():
    lines = ["a0: &a0 [1]"] + [f"a{n}: &a{n} [*a{n - 1}]" for n in range(1, 60)]
    assert problem_of("\n".join(lines)).message == "nested more than 50 levels deep"


def test_a_missing_file_a_folder_and_a_huge_file_are_problems(tmp_path):
    huge = tmp_path / "huge.yaml"
    huge.write_bytes(b"#" * (YAML_FILE + 1))
    for path, message in (
        (tmp_path / "none.yaml", "there is no such file"),
        (tmp_path, "this is a folder"),
        (huge, "the file has 2.0 MB"),
    ):
        with pytest.raises(SpecError) as caught:
            read_text(path)
        assert message in caught.value.problems[0].message
        assert caught.value.problems[0].path == str(path)


def test_bytes_that_are_not_utf_8_are_located(tmp_path):
    path = tmp_path / "latin.yaml"
    path.write_bytes("a: 1\nb: gr\u00fcn\n".encode("latin-1"))
    with pytest.raises(SpecError) as caught:
        read_text(path)
    problem = caught.value.problems[0]
    assert (problem.line, problem.column, problem.message) == (2, 6, "not UTF-8 text")


def test_a_byte_order_mark_is_no_part_of_the_file(tmp_path):
    path = tmp_path / "bom.yaml"
    path.write_bytes(b"\xef\xbb\xbfa: 1\n")
    assert parse(read_text(path)).plain() == {"a": 1}


def test_a_value_of_an_option_is_yaml_too():
    source = Source("--set a=b")
    assert parse_value("[1, {a: on}]", source).plain() == [1, {"a": "on"}]
    assert parse_value("", source).plain() is None
    assert parse_value("2 s", source).plain() == "2 s"
    with pytest.raises(SpecError) as caught:
        parse_value("[1", source)
    assert str(caught.value).startswith("--set a=b: `[1` is not a YAML value")
