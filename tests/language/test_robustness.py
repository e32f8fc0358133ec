import random
import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.core.errors import SpecError
from harness.language.reading.load import load_scenario, parse_scenario

FILES = Path(__file__).parent / "files"
DESIGN = (FILES / "design.yaml").read_text(encoding="utf-8")
TOKENS = [
    *("${lift}", "${x}", "null", "[]", "{}", "-1", "1e400", "true", "{a:b}", "*a", "|", "~", "?"),
    *("'", '"', "\t", "\0", "\u2028", "5 cm", "5 m**m", "5 m/", "a: b", "- ", "&a ", "!!str "),
    *("<<: *a", "\n", "  ", "do: lin", "until: x", "always: lifted", "expect: [grasped: a]"),
]
quick = settings(max_examples=200)


def load_or_refuse(text, overrides=None):
    """Whatever a file says: a scenario, or problems that can be printed."""
    problems = []
    try:
        parse_scenario(text, Path("f.yaml"), overrides)
    except SpecError as error:
        problems = [str(problem) for problem in error.problems]
    assert all(problems)


@quick
@given(st.text())
def test_random_text_is_refused_and_never_crashes(text):
    load_or_refuse(text)


@quick
@given(st.text(), st.text())
def test_random_overrides_are_refused_or_taken_and_never_crash(path, value):
    load_or_refuse(DESIGN, {path: value})


@quick
@given(st.binary())
def test_random_bytes_are_refused_and_never_crash(tmp_path_factory, data):
    path = tmp_path_factory.getbasetemp() / "random.yaml"
    path.write_bytes(data)
    with pytest.raises(SpecError) as caught:
        load_scenario(path)
    assert caught.value.problems[0].path == str(path)


@pytest.mark.nightly(but=[0, 1])
@pytest.mark.parametrize("seed", range(4))
def test_a_damaged_scenario_is_refused_or_taken_and_never_crashes(seed):
    rng = random.Random(seed)
    for _ in range(150):
        text = DESIGN
        for _ in range(rng.randint(1, 4)):
            words = list(re.finditer(r"[\w.$]+", text))
            word = rng.choice(words)
            other = rng.choice([*TOKENS, rng.choice(words)[0], ""])
            text = text[: word.start()] + other + text[word.end() :]
        load_or_refuse(text)


@pytest.mark.parametrize("value", [".nan", ".inf", "-.inf", "1e999"])
def test_numbers_that_are_not_finite_are_refused_wherever_they_stand(value):
    for old in ("0.10", "0.32", "0.3,", "5 cm", "7\n"):
        text = DESIGN.replace(old, old.replace(old.strip(",\n"), value), 1)
        assert text != DESIGN
        with pytest.raises(SpecError, match="not a finite number"):
            parse_scenario(text, Path("f.yaml"))


def test_an_infinite_quantity_with_a_unit_is_refused():
    with pytest.raises(SpecError) as caught:
        parse_scenario(DESIGN.replace("5 cm", "1e999 cm"), Path("f.yaml"))
    assert "finite" in caught.value.problems[0].message
