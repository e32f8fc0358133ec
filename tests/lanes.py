"""The default and the nightly run.

`@pytest.mark.nightly(but=["a"])` leaves the parameters `a` of a test in the default run, where they
represent the others; `@pytest.mark.nightly(only=["b"])` leaves all but `b` there. A number is the
position in the test's only list of parameters, from 0 on, for those with long names.
"""

from collections import defaultdict
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis.strategies import SearchStrategy


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Take the mark from tests whose parameters are part of the default run."""
    named: dict[str, set[str | int]] = defaultdict(set)
    found: dict[str, set[str | int]] = defaultdict(set)
    for item in items:
        mark = next((each for each in item.own_markers if each.name == "nightly"), None)
        if mark is None or not mark.kwargs:
            continue
        [(word, parameters)] = mark.kwargs.items()
        name, _, identifier = item.nodeid.removesuffix("]").partition("[")
        places = set(item.callspec.indices.values())
        own = {identifier} | (places if len(places) == 1 else set())
        named[name].update(parameters)
        found[name] |= own
        if bool(own & set(parameters)) == (word == "but"):
            item.own_markers.remove(mark)
    if any("::" in argument for argument in config.args):
        return  # only some parameters were collected
    for name, names in named.items():
        if absent := names - found[name]:
            raise pytest.UsageError(f"{name} has no parameters {absent}")


def property_test(
    *strategies: SearchStrategy, few: int, many: int
) -> Callable[[Callable], Callable]:
    """A property of `few` examples in the default run, and of `many` in the nightly run."""

    def decorate(function: Callable[..., None]) -> Callable[[int], None]:
        @pytest.mark.nightly(only=[str(many)])
        @pytest.mark.parametrize("examples", [few, many])
        def test(examples: int) -> None:
            settings(max_examples=examples)(given(*strategies)(function))()

        test.__name__, test.__doc__ = function.__name__, function.__doc__
        return test

    return decorate
