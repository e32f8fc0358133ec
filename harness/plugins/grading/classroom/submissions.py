"""Submissions of a class: folders, archives or single files, copied into a folder of their own."""

from __future__ import annotations

import os
import re
import shutil
import stat
import tarfile
import zipfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import IO

from harness.core.errors import HarnessError
from harness.core.files import open_regular
from harness.core.limits import SUBMISSION_FILES
from harness.plugins.grading.assignment import Assignment
from harness.suite.discovery import UsageError

BLOCK = 2**20  # [bytes]
ARCHIVES = (".zip", ".tar", ".tar.gz", ".tgz", ".tar.xz", ".tar.bz2")
BAGS = (".mcap", ".db3", ".bag", ".csv")
LEFT_OUT = ("__MACOSX", "__pycache__")


class SubmissionError(HarnessError):
    """A submission that cannot be used; its text is for the student."""


@dataclass(frozen=True)
class Submission:
    """What one student handed in.

    Attributes:
        name: The name of the folder or file, without the endings of archives.
        folder: A name for files that follow from it, unique in the class.
        path: What was handed in.
    """

    name: str
    folder: str
    path: Path


def find_submissions(place: Path) -> list[Submission]:
    """Each entry of a folder as a submission, in the order of their names.

    Raises:
        UsageError: There is no such folder, or nothing in it.
    """
    if not place.is_dir():
        raise UsageError(f"'{place}' is no folder of submissions")
    paths = [path for path in sorted(place.iterdir()) if not _is_left_out(path.name)]
    if not paths:
        raise UsageError(f"'{place}' has no submissions: folders, archives or files")
    found: dict[str, Submission] = {}
    for path in paths:
        single = one_submission(path)
        folder, number = single.folder, 2
        while folder.lower() in found:
            folder, number = f"{single.folder}_{number}", number + 1
        found[folder.lower()] = Submission(single.name, folder, path)
    return list(found.values())


def one_submission(path: Path) -> Submission:
    """What stands at a path as the submission of one student."""
    name = path.name or path.resolve().name
    for ending in (*ARCHIVES, ".scenario.yaml", ".yaml", ".py", *BAGS):
        if path.is_file() and name.lower().endswith(ending) and len(name) > len(ending):
            name = name[: -len(ending)]
            break
    name = name.encode(errors="replace").decode()
    return Submission(name, re.sub(r"[^\w.-]+", "_", name).strip(".")[:80] or "submission", path)


def unpack(submission: Submission, target: Path, megabytes: int) -> Path:
    """Copy a submission into a folder; an archive is unpacked, and one inside a folder too.

    Args:
        target: A folder that does not exist yet.
        megabytes: What all of its files may have.

    Returns:
        The folder of the submission's files: the target, or the only folder in it.

    Raises:
        SubmissionError: It is too large, damaged, or has links or paths that leave it.
    """
    source = submission.path
    for depth in range(2):
        place = target / str(depth)
        try:
            with ExitStack() as stack:
                _write_all(_entries(source, stack), place, megabytes * 10**6)
        except HarnessError:
            raise
        except Exception as error:
            # whatever the libraries raise on damaged bytes, passwords and impossible names
            reason = str(error).partition("\n")[0].rstrip(":")
            raise SubmissionError(f"it cannot be unpacked: {reason}") from error
        while len(inside := list(place.iterdir())) == 1 and inside[0].is_dir():
            place = inside[0]
        if not (len(inside) == 1 and _is_archive(inside[0])):
            return place
        source = inside[0]
    raise SubmissionError("it is an archive in an archive in an archive")


def _is_left_out(name: str) -> bool:
    return name.startswith(".") or name in LEFT_OUT


def _is_archive(path: Path) -> bool:
    return path.is_file() and path.name.lower().endswith(ARCHIVES)


Entry = tuple[str, IO[bytes]]
"""The name of a file in a submission, and its content."""


def _entries(source: Path, stack: ExitStack) -> Iterator[Entry]:
    """The files of a folder, an archive, or one file.

    Raises:
        SubmissionError: It has links, devices or pipes.
    """
    if source.is_symlink():
        raise SubmissionError(f"'{source.name}' is a link; hand in files")
    if source.is_dir():
        for place, folders, names in os.walk(source):
            folders[:] = sorted(each for each in folders if not _is_left_out(each))
            for name in [*folders, *sorted(names)]:
                path = Path(place, name)
                inside = path.relative_to(source).as_posix()
                if not stat.S_ISREG(mode := path.lstat().st_mode) and not stat.S_ISDIR(mode):
                    raise _not_plain(inside)
                if stat.S_ISREG(mode):
                    with path.open("rb") as content:
                        yield inside, content
    elif not _is_archive(source):
        yield source.name, stack.enter_context(open_regular(source))
    elif zipfile.is_zipfile(source):
        yield from _of_zip(stack.enter_context(zipfile.ZipFile(source)))
    else:
        yield from _of_tar(stack.enter_context(tarfile.open(source)))  # noqa: SIM115 - the stack closes it


def _of_zip(archive: zipfile.ZipFile) -> Iterator[Entry]:
    if len(archive.filelist) > 2 * SUBMISSION_FILES:  # folders count, too
        count = len(archive.filelist)
        raise SubmissionError(f"it has {count} files; at most {SUBMISSION_FILES} may be")
    for each in archive.filelist:
        kind = stat.S_IFMT(each.external_attr >> 16)
        if kind not in (0, stat.S_IFREG, stat.S_IFDIR):
            raise _not_plain(each.filename)
        if not each.is_dir():
            with archive.open(each) as content:
                yield each.filename, content


def _of_tar(archive: tarfile.TarFile) -> Iterator[Entry]:
    for each in archive:
        if not each.isfile() and not each.isdir():
            raise _not_plain(each.name)
        content = archive.extractfile(each) if each.isfile() else None
        if content is not None:
            with content:
                yield each.name, content


def _not_plain(name: str) -> SubmissionError:
    return SubmissionError(f"'{name}' is a link or a device; hand in files and folders")


def _write_all(entries: Iterator[Entry], target: Path, most: int) -> None:
    """Write files below a folder; what they have is counted while it is read.

    Raises:
        SubmissionError: They are too many or too large, or one would be outside the folder.
    """
    target.mkdir(parents=True)
    left, count = most, 0
    for name, content in entries:
        parts = PurePosixPath(name.replace("\\", "/")).parts
        if name.startswith(("/", "\\")) or ".." in parts or any(":" in each for each in parts[:1]):
            raise SubmissionError(f"'{name}' leads out of the submission")
        if any(map(_is_left_out, parts)):
            continue
        count += 1
        if count > SUBMISSION_FILES:
            raise SubmissionError(f"it has more than {SUBMISSION_FILES} files")
        file = target.joinpath(*parts)
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("wb") as copy:
            while block := content.read(min(BLOCK, left + 1)):
                left -= len(block)
                if left < 0:
                    raise SubmissionError(f"its files have more than {most // 10**6} MB")
                copy.write(block)


def main_file(folder: Path, assignment: Assignment) -> Path:
    """The file or folder of a submission that is graded.

    Raises:
        SubmissionError: There is none, or several.
    """
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    if assignment.kind == "node":
        return folder
    if assignment.ik is not None:
        text = re.compile(rf"^(?:async\s+)?def\s+{re.escape(assignment.ik.function)}\b", re.M)
        found = [each for each in files if each.suffix == ".py" and text.search(_start(each))]
        return _only(found, f"a Python file with the function `{assignment.ik.function}`")
    if assignment.kind == "recording":
        bags = [each.parent for each in files if each.name == "metadata.yaml"]
        singles = [each for each in files if each.suffix.lower() in BAGS]
        what = "a recording: a rosbag2 folder, .mcap, .db3, .bag or .csv"
        return _only(bags or singles, what)
    named = [each for each in files if each.name.endswith(".scenario.yaml")]
    return _only(named or [each for each in files if each.suffix == ".yaml"], "a .scenario.yaml")


def _start(file: Path) -> str:
    with file.open("rb") as content:
        return content.read(BLOCK).decode(errors="replace")


def _only(found: Sequence[Path], what: str) -> Path:
    if len(found) == 1:
        return found[0]
    names = ", ".join(each.name for each in found[:5])
    raise SubmissionError(
        f"it has {len(found)} files that may be {what}: {names}" if found else f"it lacks {what}"
    )


def remove(folder: Path) -> None:
    """Remove what a submission left, whatever rights its folders have."""
    for place, folders, _names in os.walk(folder):
        for name in folders:
            path = Path(place, name)
            if not path.is_symlink():
                path.chmod(0o700)
    shutil.rmtree(folder)
