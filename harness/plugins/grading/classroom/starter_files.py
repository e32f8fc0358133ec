"""Writes the folder of a grading system: its scripts, and an assignment to begin with."""

from __future__ import annotations

import shutil
import tempfile
import zipfile
from importlib.metadata import version
from pathlib import Path

from harness.core.registry import OWN_PACKAGE
from harness.suite.discovery import UsageError

FILES = Path(__file__).with_name("starter")
EXECUTABLE = ("setup.sh", "run_autograder")


def write_starter(system: str, folder: Path, archive: str = "") -> list[str]:
    """Write a folder that does not exist yet, whole or not at all.

    Args:
        system: The name of the folder with the system's files.
        folder: The folder to write.
        archive: The name of a zip file of everything but the README; empty for none.

    Returns:
        The names of the written files, relative to the folder.

    Raises:
        UsageError: The folder exists, or cannot be written.
    """
    own = version(OWN_PACKAGE)
    if folder.exists():
        raise UsageError(f"'{folder}' exists already; nothing was written")
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=folder.parent) as place:
            new = Path(place) / folder.name
            shutil.copytree(FILES / system, new, ignore=shutil.ignore_patterns("__pycache__"))
            shutil.copytree(FILES / "assignment", new / "assignment")
            for file in new.iterdir():
                if file.is_file():
                    text = file.read_text(encoding="utf-8").replace("@VERSION@", own)
                    file.write_text(text, encoding="utf-8")
                    file.chmod(0o755 if file.name in EXECUTABLE else 0o644)
            names = sorted(f.relative_to(new).as_posix() for f in new.rglob("*") if f.is_file())
            if archive:
                with zipfile.ZipFile(new / archive, "w", zipfile.ZIP_DEFLATED) as target:
                    for name in names:
                        if name != "README.md":
                            target.write(new / name, name)
                names.append(archive)
            new.rename(folder)
    except OSError as error:
        raise UsageError(f"cannot write '{folder}': {error.strerror}") from error
    return names
