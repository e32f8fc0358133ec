"""The files of a suite in its folder."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from harness.core.errors import HarnessError
from harness.reporting.json_text import json_text
from harness.reporting.suite.history import Key
from harness.reporting.suite.junit import junit_xml
from harness.reporting.suite.page import suite_html
from harness.reporting.suite.record import SuiteRecord, results_document

PAGE = "index.html"
JUNIT = "junit.xml"
RESULTS = "results.json"


def write_suite(
    folder: Path,
    record: SuiteRecord,
    exit_code: int,
    history: Mapping[Key, Sequence[float | None]] | None = None,
) -> Path:
    """Write page, JUnit XML and results; each is whole or as it was.

    Returns:
        The page's path in the folder.

    Raises:
        HarnessError: A file cannot be written.
    """
    texts = {
        RESULTS: json_text(results_document(record, exit_code)),
        JUNIT: junit_xml(record),
    }
    return write_page(folder, record, texts, history)


def write_page(
    folder: Path,
    record: SuiteRecord,
    others: Mapping[str, str],
    history: Mapping[Key, Sequence[float | None]] | None = None,
) -> Path:
    """Write the page of many runs, and other files first; each is whole or as it was.

    Args:
        folder: Made where it is missing.
        record: The record of the suite.
        others: Name -> text of the other files.
        history: Worst margins of earlier runs.

    Returns:
        The page's path in the folder.

    Raises:
        HarnessError: A file cannot be written.
    """
    texts = {**others, PAGE: suite_html(record, folder, history)}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in texts.items():
            _replace(folder / name, text)
    except OSError as error:
        raise HarnessError(f"'{folder}' cannot be written: {error.strerror}") from error
    return folder / PAGE


def _replace(file: Path, text: str) -> None:
    part = file.with_name(f".{file.name}.{os.getpid()}")
    try:
        part.write_text(text, encoding="utf-8", newline="")
        part.replace(file)
    finally:
        part.unlink(missing_ok=True)
