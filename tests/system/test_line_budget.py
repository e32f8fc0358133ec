"""The packages of harness stay within the numbers of lines in pyproject.toml."""

import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
BUDGETS = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["armharness"]["lines"]


def lines_by_package() -> dict[str, int]:
    """Lines of Python and C in each package of harness, and in each plug-in."""
    counted: dict[str, int] = {}
    for kind in ("*.py", "*.c", "*.h"):
        for path in (ROOT / "harness").rglob(kind):
            parts = path.relative_to(ROOT / "harness").parts
            is_plugin = parts[0] == "plugins" and len(parts) > 2
            package = ".".join(parts[: 1 + is_plugin]).removesuffix(".py")
            count = len(path.read_text(encoding="utf-8").splitlines())
            counted[package] = counted.get(package, 0) + count
    return counted


def test_every_package_has_a_budget_and_stays_within_it():
    counted = lines_by_package()
    assert counted.keys() == BUDGETS.keys()
    beyond = {name: (n, BUDGETS[name]) for name, n in counted.items() if n > BUDGETS[name]}
    assert not beyond, f"lines and budget: {beyond}; delete, or raise it and say why in the commit"
