"""Readers of what a class hands in, and of its assignment."""

from __future__ import annotations

import io
import tarfile
import zipfile
from pathlib import Path

from tests.campaigns import mutation
from tests.campaigns.reader import Read, Reader, after_its_name, of_file, put


def _archives(folder: Path) -> list[bytes]:
    del folder
    files = {
        "work/pick.scenario.yaml": b"scenario: x\n",
        "work/ik.py": b"def ik(): pass\n",
        "a.csv": b"1",
    }
    found: list[bytes] = []
    for method in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        stream = io.BytesIO()
        with zipfile.ZipFile(stream, "w", method) as archive:
            for name, content in files.items():
                archive.writestr(name, content)
        found.append(b".zip:" + stream.getvalue())
    for kind in ("", "gz", "xz", "bz2"):
        stream = io.BytesIO()
        with tarfile.open(fileobj=stream, mode=f"w:{kind}") as archive:
            for name, content in files.items():
                about = tarfile.TarInfo(name)
                about.size = len(content)
                archive.addfile(about, io.BytesIO(content))
        found.append(f".tar{'.' * bool(kind)}{kind}:".encode() + stream.getvalue())
    return found


def _begin_archive(folder: Path) -> Read:
    import shutil

    from harness.plugins.grading.classroom.submissions import one_submission, unpack

    del folder

    def read(folder: Path, data: bytes) -> None:
        suffix, _, content = data.partition(b":")
        path = put(folder, f"work{suffix.decode()}", content)
        try:
            unpack(one_submission(path), folder / "unpacked", 1)
        finally:
            path.unlink()
            outside = [each.name for each in folder.iterdir() if each.name != "unpacked"]
            shutil.rmtree(folder / "unpacked", ignore_errors=True)
        assert not outside, outside

    return read


ROSTER = b"""\
submission,email,student_id,first_name,last_name,section
ada,ada@example.org,1,Ada,L,a
"b c",b@example.org,2,"B ""the"" second",C,b
"""


def _read_roster(path: Path) -> None:
    from harness.plugins.grading.classroom.tables import read_roster

    read_roster(path)


ASSIGNMENT = b"""\
assignment: Reach
description: Move to three places.
scenario: reach.scenario.yaml
takes: [steps]
points: 10
hidden:
  - {seed: 4}
  - {set: {objects.block.pose.xyz: [0.2, 0, 0.02]}}
limits: {processor_time: 30 s, memory: 1000, processes: 20, files: 100}
"""


def _begin_assignment(folder: Path) -> Read:
    from harness.plugins.grading.assignment import read_assignment
    from tests.damaged.trials import TINY

    put(folder, "reach.scenario.yaml", TINY.encode())

    def read(folder: Path, data: bytes) -> None:
        put(folder, "assignment.yaml", data)
        read_assignment(folder)

    return read


READERS: dict[str, Reader] = {
    "submission": Reader(
        _archives, after_its_name(mutation.of_bytes), _begin_archive, is_named=True
    ),
    "roster": Reader(lambda _: [ROSTER], mutation.of_text, of_file("roster.csv", _read_roster)),
    "assignment": Reader(lambda _: [ASSIGNMENT], mutation.of_yaml, _begin_assignment),
}
