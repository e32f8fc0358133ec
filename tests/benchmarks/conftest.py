"""Collects what the benchmarks measure and prints it as tables at the end."""

import pytest

TABLES = pytest.StashKey()


def pytest_configure(config):
    config.stash[TABLES] = {}


def pytest_ignore_collect(config):
    """Import no benchmark that the expression of `-m` leaves out."""
    return True if "not benchmark" in config.option.markexpr else None


@pytest.fixture
def print_row(request):
    """Puts a row under a table's heading: `print_row("heading", "name", "1.0 s", ...)`."""

    def row(heading, *cells):
        request.config.stash[TABLES].setdefault(heading, []).append(cells)

    return row


def pytest_terminal_summary(terminalreporter, config):
    for heading, rows in config.stash.get(TABLES, {}).items():
        terminalreporter.section(heading, sep="-")
        widths = [max(len(row[i]) for row in rows if i < len(row)) for i in range(len(rows[0]))]
        for row in rows:
            padded = (cell.ljust(width) for cell, width in zip(row, widths, strict=False))
            terminalreporter.write_line("  ".join(padded).rstrip())
