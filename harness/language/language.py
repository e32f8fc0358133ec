"""The words of the file that expectations are made of, by their place in the grammar."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from harness.core.registry import Registry, registry
from harness.language.annotations import keys_of
from harness.language.expectation import KIND, ExpectationFields, PredicateFields, TemporalFields
from harness.language.step import StepFields

PLACEHOLDER_VERB, PLACEHOLDER_WORD = "settle", "within_limits"
"""What takes the place of a step or an expectation that cannot be read, so that indices stay."""

UNTIL = "until"  # stands next to `always`: `{always: A, until: B}` is the expectation `until`


class WordsOf(Mapping[str, type[ExpectationFields]]):
    """The registered expectations of some base class, but for `until`; imported when looked up."""

    def __init__(self, base: type[ExpectationFields]) -> None:
        self._base = base
        self._registry: Registry[type[ExpectationFields]] = registry(KIND)

    def __getitem__(self, word: str) -> type[ExpectationFields]:
        if word not in self:
            raise KeyError(word)
        return self._registry[word]

    def __contains__(self, word: object) -> bool:
        if not isinstance(word, str) or word == UNTIL or word not in self._registry:
            return False
        return issubclass(self._registry[word], self._base)

    def __iter__(self) -> Iterator[str]:
        return iter(word for word in self._registry if word in self)

    def __len__(self) -> int:
        return len(list(iter(self)))


EXPECTATIONS = WordsOf(ExpectationFields)
PREDICATES = WordsOf(PredicateFields)
TEMPORAL = WordsOf(TemporalFields)

KEYS_BY_VERB = tuple(keys_of(StepFields))  # stand next to a verb, never inside its content

KEYS_BY_PREDICATE = tuple(keys_of(TemporalFields))
"""Words that stand next to a predicate or a temporal word (or inside, as in the models)."""
