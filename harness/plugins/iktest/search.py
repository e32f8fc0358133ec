"""Drawing cases and shrinking those that show something, deterministic and within a budget."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from random import Random
from typing import TypeVar

from hypothesis import HealthCheck, Phase, Verbosity, find, given, seed, settings
from hypothesis import strategies as st
from hypothesis.errors import HypothesisException
from hypothesis.internal.conjecture.providers import HypothesisProvider

C = TypeVar("C")
F = TypeVar("F")

SHRINK_CALLS = 250  # cases tried at most after the first that shows what is sought

QUIET = settings(
    database=None,
    derandomize=False,
    deadline=None,
    suppress_health_check=[
        HealthCheck.too_slow,
        HealthCheck.data_too_large,
        HealthCheck.filter_too_much,
        HealthCheck.large_base_example,
        HealthCheck.nested_given,
    ],
    verbosity=Verbosity.quiet,
    print_blob=False,
)


class _Enough(BaseException):
    """Ends Hypothesis at once; it catches every Exception."""


def draw(
    strategy: st.SearchStrategy[C], visit: Callable[[C], bool], count: int, number: int
) -> None:
    """Visit what a strategy draws, until a visit returns False.

    Args:
        number: The seed; `shrink_case` with the same one draws the same cases.
    """

    @seed(Random(number).getrandbits(64))  # the one that `find` makes of a generator
    @settings(QUIET, max_examples=count, phases=[Phase.generate])
    @given(strategy)
    def run(case: C) -> None:
        if not visit(case):
            raise _Enough

    with _independent_of_loaded_modules(), suppress(_Enough):
        run()


def shrink_case(
    strategy: st.SearchStrategy[C],
    shows: Callable[[C], F | None],
    size: Callable[[C], tuple[float, ...]],
    count: int,
    number: int,
    cost: Callable[[], int] = lambda: 1,
) -> F | None:
    """What the smallest case shows that shows something.

    Args:
        shows: What a case shows, or None.
        size: What makes one case smaller than another.
        count: Cases drawn at most until one shows it.
        cost: The cost of the last case, in cases: hangs use the budget up sooner.
    """
    best: list[tuple[tuple[float, ...], F]] = []
    spent = 0

    def condition(case: C) -> bool:
        nonlocal spent
        flaw = shows(case)
        if best:
            spent += cost()
        if flaw is not None and (not best or size(case) < best[0][0]):
            best[:] = [(size(case), flaw)]
        if spent >= SHRINK_CALLS:
            raise _Enough
        return flaw is not None

    limits = settings(QUIET, max_examples=count, phases=[Phase.generate, Phase.shrink])
    # Enough; none; or a function that answers differently when called again.
    ends = (_Enough, HypothesisException, ExceptionGroup)
    with _independent_of_loaded_modules(), suppress(*ends):
        find(strategy, condition, settings=limits, random=Random(number))
    return best[0][1] if best else None


@contextmanager
def _independent_of_loaded_modules() -> Iterator[None]:
    """Draw the same cases whatever modules are loaded.

    Hypothesis mixes in numbers that stand in the code of modules that are not installed packages,
    as far as they are loaded, and has no setting against it (6.170).
    """
    name = "_maybe_draw_constant"
    draws = getattr(HypothesisProvider, name, None)
    if draws is None:
        yield
        return
    setattr(HypothesisProvider, name, lambda *_arguments, **_options: None)
    try:
        yield
    finally:
        setattr(HypothesisProvider, name, draws)
