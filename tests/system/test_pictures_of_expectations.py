"""The reference's pictures of expectations show their results in real runs."""

import html
import importlib
import re

import pytest

from harness.language.language import PREDICATES


@pytest.fixture(scope="module")
def generator():
    """The module that draws them, which imports matplotlib."""
    return importlib.import_module("docs.generators.expectation_pictures")


@pytest.fixture(scope="module")
def panels(generator):
    """What each picture shows, from runs of now."""
    return dict(generator.pictures())


def without_numbers(text):
    return re.sub(r"\d+(\.\d+)?", "#", html.unescape(text))


@pytest.mark.nightly
def test_every_predicate_has_a_small_picture_of_a_pass_and_a_failure(panels, generator):
    assert set(panels) == set(PREDICATES)
    for word, pair in panels.items():
        assert [verdict.status for *_, verdict in pair] == ["passed", "failed"], word
        assert (generator.FOLDER / f"{word}.svg").stat().st_size < 60_000


@pytest.mark.nightly
def test_the_pictures_say_what_the_runs_of_now_say(panels, generator):
    for word, pair in panels.items():
        kept = without_numbers(
            generator.words_in((generator.FOLDER / f"{word}.svg").read_text(encoding="utf-8"))
        )
        for text, _, _, verdict in pair:
            title = without_numbers(generator.title_of(text, verdict).replace("\n", " "))
            assert title in kept, f"{word}.svg is of other runs; {generator.RENEW}"
