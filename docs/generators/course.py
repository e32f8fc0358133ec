"""What the pages of the course show: each starting file and each typical mistake, checked.

Run as a script, it writes the pages; arguments name some exercises, such as 03_grasp.
"""

from __future__ import annotations

import contextlib
import io
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from docs import ROOT
from docs.generators.examples import COLUMNS
from harness.cli.main import main as harness
from harness.core.printable import fitted
from harness.plugins.grading.course import Exercise, exercises

FOLDER = ROOT / "docs/course"
REGION = re.compile(r"(?ms)^<!-- (\w+) -->\n.*?^<!-- end -->$")
LEFT_OUT = re.compile(
    r"✓ .*|  +warning: .*|report: .*|  speed .*| +picture:? .*|\d+ findings? in .*"
    r"|note: \d+ commands; .*|this machine is too slow .*"
)
"""Lines that pages leave out: rows that hold, times of the wall clock, names of files."""


def checked(exercise: Exercise, file: Path) -> str:
    """What `harness course check` prints about a file in place of the student's."""
    with tempfile.TemporaryDirectory() as place, contextlib.chdir(place):
        work = Path(exercise.folder_name)
        work.mkdir()
        shutil.copy(file, work / exercise.file_name)
        printed = io.TextIOWrapper(io.BytesIO(), encoding="utf-8")
        with contextlib.redirect_stdout(printed):
            harness(["course", "check", str(work), "--no-open"])
        printed.seek(0)
        return printed.read()


def shown(printed: str) -> str:
    """A check's output as a page has it."""
    kept = [line for line in printed.splitlines() if not LEFT_OUT.fullmatch(line)]
    lines = [part for line in kept for part in fitted(line, COLUMNS) or [""]]
    text = re.sub(r"\n{2,}", "\n\n", "\n".join(lines)).strip("\n")
    return f"```text\n{text}\n```"


def mistakes(exercise: Exercise) -> list[Path]:
    """The files of the typical mistakes."""
    return sorted((exercise.assignment.folder / "mistakes").iterdir())


def cause(file: Path) -> str:
    """The first line of a mistake's file: what is wrong."""
    first, _, _ = file.read_text(encoding="utf-8").partition("\n")
    return first.strip('#" ')


def own_lines(exercise: Exercise, file: Path) -> str:
    """The lines of a mistake that the answer does not have, each once, as a list."""
    [answer] = exercise.assignment.folder.glob("answer.*")
    known = set(code_lines(answer))
    own = [line for line in code_lines(file)[file.suffix == ".py" :] if line not in known]
    listed = "".join(f"- `{line}`\n" for line in dict.fromkeys(own))
    return listed or "- a line of the answer is missing\n"


def code_lines(file: Path) -> list[str]:
    """The lines of a file without comments and indentation."""
    lines = file.read_text(encoding="utf-8").splitlines()
    bare = (re.sub(r"(^|\s+)# .*", "", line).strip() for line in lines)
    return [line for line in bare if line]


def mistake(exercise: Exercise, file: Path) -> str:
    """What is wrong in a mistake's file, its lines, and what it leaves."""
    title, lines = cause(file).rstrip("."), own_lines(exercise, file)
    return f"### {title}\n\n{lines}\n{shown(checked(exercise, file))}\n"


def regions(exercise: Exercise) -> Iterator[tuple[str, str]]:
    """The name and the text of each part of a page that is generated."""
    model = exercise.assignment.model
    yield "facts", f"{model.description} Estimated at {model.minutes} minutes."
    yield "start", shown(checked(exercise, exercise.start))
    yield "mistakes", "\n".join(mistake(exercise, file) for file in mistakes(exercise))


def page_of(exercise: Exercise) -> Path:
    """The page of an exercise."""
    return FOLDER / f"{exercise.folder_name}.md"


def with_regions(exercise: Exercise) -> str:
    """The page of an exercise with its generated parts as they are now."""
    made = dict(regions(exercise))
    text = page_of(exercise).read_text(encoding="utf-8")
    return REGION.sub(lambda found: f"<!-- {found[1]} -->\n{made[found[1]]}\n<!-- end -->", text)


def index() -> str:
    """The first page of the course with its table of exercises."""
    rows = ["| exercise | minutes, estimated | what it teaches |", "| --- | --- | --- |"]
    for number, exercise in exercises().items():
        model = exercise.assignment.model
        link = f"[{number}. {model.assignment}]({page_of(exercise).name})"
        rows.append(f"| {link} | {model.minutes} | {model.description} |")
    table = "\n".join(rows)
    text = (FOLDER / "README.md").read_text(encoding="utf-8")
    return REGION.sub(lambda found: f"<!-- {found[1]} -->\n{table}\n<!-- end -->", text)


def has_rclpy() -> bool:
    """Whether the Python that nodes are started with has rclpy."""
    words = ["python3", "-c", "import rclpy"]
    return subprocess.run(words, capture_output=True, check=False).returncode == 0


def main(names: list[str]) -> None:
    """Write the pages of some exercises, or all pages."""
    (FOLDER / "README.md").write_text(index(), encoding="utf-8")
    for exercise in exercises().values():
        if names and exercise.folder_name not in names:
            continue
        if exercise.assignment.model.node and not has_rclpy():
            sys.stderr.write(f"{exercise.folder_name} needs rclpy in the python3 of the PATH\n")
        else:
            page_of(exercise).write_text(with_regions(exercise), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
