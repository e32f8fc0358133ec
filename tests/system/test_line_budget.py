"""The packages of harness stay within the numbers of lines in pyproject.toml."""

import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
BUDGETS = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["armharness"]["lines"]


def lines_by_package() -> dict[str, int]:
    """Lines of Python and C in each package of harness."""
    counted: dict[str, int] = {}
    for kind in ("*.py", "*.c", "*.h"):
        for path in (ROOT / "harness").rglob(kind):
            package = path.relative_to(ROOT / "harness").parts[0].removesuffix(".py")
            count = len(path.read_text(encoding="utf-8").splitlines())
            counted[package] = counted.get(package, 0) + count
    return counted


def test_every_package_has_a_budget_and_stays_within_it():
    counted = lines_by_package()
    assert counted.keys() == BUDGETS.keys()
    beyond = {name: (n, BUDGETS[name]) for name, n in counted.items() if n > BUDGETS[name]}
    assert not beyond, f"lines and budget: {beyond}; delete, or raise it and say why in the commit"
