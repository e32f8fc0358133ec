"""Submissions: found, unpacked, and refused where they would do harm."""

import io
import os
import tarfile
import zipfile

import pytest

from harness.plugins.grading.assignment import Assignment
from harness.plugins.grading.classroom.submissions import (
    SubmissionError,
    find_submissions,
    main_file,
    one_submission,
    unpack,
)
from harness.suite.discovery import UsageError

SCENARIO = Assignment(assignment="One", scenario="a.scenario.yaml")
FUNCTION = Assignment.model_validate({"assignment": "One", "ik": "ur5e"})
RECORDING = Assignment.model_validate({"assignment": "One", "recording": "a.scenario.yaml"})


def zipped(file, files):
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return file


def tarred(file, members, mode="w:gz"):
    with tarfile.open(file, mode) as archive:
        for member, content in members:
            archive.addfile(member, io.BytesIO(content))
    return file


def member(name, kind=tarfile.REGTYPE, link="", size=0):
    info = tarfile.TarInfo(name)
    info.type, info.linkname, info.size = kind, link, size
    return info


def unpacked(path, tmp_path, megabytes=1):
    return unpack(one_submission(path), tmp_path / "out", megabytes)


def refusal(path, tmp_path, megabytes=1):
    with pytest.raises(SubmissionError) as refused:
        unpacked(path, tmp_path, megabytes)
    written = [
        file
        for file in tmp_path.rglob("*")
        if file.is_file() and not file.is_symlink() and file != path
    ]
    assert all(file.is_relative_to(tmp_path / "out") for file in written)
    return str(refused.value)


def test_a_class_is_a_folder_of_folders_archives_and_files(tmp_path):
    (tmp_path / "Ada Lovelace_123").mkdir()
    zipped(tmp_path / "grace.zip", {"a": "b"})
    tarred(tmp_path / "grace.tar.gz", [])
    (tmp_path / "kurt.scenario.yaml").write_text("steps: []")
    (tmp_path / ".DS_Store").write_text("x")
    (tmp_path / "__MACOSX").mkdir()
    found = find_submissions(tmp_path)
    assert [(each.name, each.folder) for each in found] == [
        ("Ada Lovelace_123", "Ada_Lovelace_123"),
        ("grace", "grace"),
        ("grace", "grace_2"),
        ("kurt", "kurt"),
    ]


def test_no_submissions_are_an_error_of_the_command(tmp_path):
    with pytest.raises(UsageError, match="no folder of submissions"):
        find_submissions(tmp_path / "none")
    with pytest.raises(UsageError, match="has no submissions"):
        find_submissions(tmp_path)


@pytest.mark.parametrize("kind", ["folder", "zip", "tar.gz", "tar", "zip in a folder"])
def test_what_was_handed_in_is_unpacked_down_to_its_files(tmp_path, kind):
    files = {"work/ik.py": "def ik(): pass", "work/data/a.txt": "1", "__MACOSX/._ik.py": "x"}
    path = tmp_path / f"ada.{kind}"
    if kind == "zip in a folder":
        path.mkdir()
        zipped(path / "work.zip", files)
    elif kind == "folder":
        for name, content in files.items():
            (path / name).parent.mkdir(parents=True, exist_ok=True)
            (path / name).write_text(content)
    elif kind == "zip":
        zipped(path, files)
    else:
        members = [(member(n, size=len(c)), c.encode()) for n, c in files.items()]
        tarred(path, members, "w:gz" if kind == "tar.gz" else "w")
    folder = unpacked(path, tmp_path)
    found = {file.relative_to(folder).as_posix() for file in folder.rglob("*") if file.is_file()}
    assert found == {"ik.py", "data/a.txt"}


@pytest.mark.parametrize(
    "name", ["../out.txt", "/tmp/harness-out.txt", "a/../../out.txt", "..\\out.txt", "C:\\out.txt"]
)
@pytest.mark.parametrize("kind", ["zip", "tar"])
def test_paths_that_lead_out_are_refused(tmp_path, name, kind):
    path = tmp_path / f"evil.{kind}"
    if kind == "zip":
        zipped(path, {name: "x"})
    else:
        tarred(path, [(member(name, size=1), b"x")], "w")
    assert "leads out of the submission" in refusal(path, tmp_path)


@pytest.mark.parametrize(
    "kind", [tarfile.SYMTYPE, tarfile.LNKTYPE, tarfile.CHRTYPE, tarfile.FIFOTYPE]
)
def test_links_and_devices_in_an_archive_are_refused(tmp_path, kind):
    path = tarred(tmp_path / "evil.tar", [(member("a", kind, "/etc/passwd"), b"")], "w")
    assert "is a link or a device" in refusal(path, tmp_path)


def test_a_link_in_a_zip_is_refused(tmp_path):
    info = zipfile.ZipInfo("a")
    info.external_attr = 0o120777 << 16
    with zipfile.ZipFile(tmp_path / "evil.zip", "w") as archive:
        archive.writestr(info, "/etc/passwd")
    assert "is a link or a device" in refusal(tmp_path / "evil.zip", tmp_path)


@pytest.mark.parametrize("place", ["file", "folder", "pipe", "itself"])
def test_links_and_pipes_in_a_folder_are_refused(tmp_path, place):
    path = tmp_path / "evil"
    if place == "itself":
        path.symlink_to("/etc")
    else:
        path.mkdir()
    if place == "pipe":
        os.mkfifo(path / "a")
    elif place != "itself":
        (path / "a").symlink_to("/etc/passwd" if place == "file" else "/etc")
    assert "is a link" in refusal(path, tmp_path)


@pytest.mark.parametrize("kind", ["zip", "tar.gz", "declared small"])
def test_a_bomb_is_stopped_at_the_size_that_is_allowed(tmp_path, kind):
    path, zeros = tmp_path / f"bomb.{kind.partition(' ')[0]}", bytes(3 * 10**6)
    if kind == "zip":
        zipped(path, {"a": zeros})
    elif kind == "tar.gz":
        tarred(path, [(member("a", size=len(zeros)), zeros)])
    else:  # the directory of the archive states another size than the data have
        path = zipped(tmp_path / "bomb.zip", {"a": zeros})
        data = path.read_bytes().replace(
            len(zeros).to_bytes(4, "little"), (9).to_bytes(4, "little")
        )
        path.write_bytes(data)
    said = refusal(path, tmp_path)
    assert "more than 1 MB" in said or "cannot be unpacked" in said
    written = [file.stat().st_size for file in (tmp_path / "out").rglob("*") if file.is_file()]
    assert sum(written) <= 10**6


def test_too_many_files_and_archives_in_archives_are_refused(tmp_path):
    many = zipped(tmp_path / "many.zip", {f"{number}.txt": "" for number in range(5001)})
    assert "more than 5000 files" in refusal(many, tmp_path)
    inner = zipped(tmp_path / "inner.zip", {"a.txt": "x"}).read_bytes()
    middle = zipped(tmp_path / "middle.zip", {"inner.zip": inner}).read_bytes()
    outer = zipped(tmp_path / "outer.zip", {"middle.zip": middle})
    with pytest.raises(SubmissionError, match="an archive in an archive in an archive"):
        unpack(one_submission(outer), tmp_path / "other", 1)


@pytest.mark.parametrize(
    "content", [b"", b"PK\x03\x04 no zip", b"\x1f\x8b\x08 no tar", bytes(range(256))]
)
@pytest.mark.parametrize("ending", [".zip", ".tar.gz"])
def test_damaged_archives_are_reported(tmp_path, content, ending):
    path = tmp_path / f"bad{ending}"
    path.write_bytes(content)
    assert "cannot be unpacked" in refusal(path, tmp_path)


@pytest.mark.parametrize("name", [b"", b"\0", b"\xff"])
def test_names_that_are_none_are_reported(tmp_path, name):
    path = zipped(tmp_path / "bad.zip", {"a": "x"})
    data = path.read_bytes()
    place = data.rindex(b"PK\x01\x02")  # of the list of files, which counts
    head = bytearray(data[place : place + 46])
    head[28:30] = len(name).to_bytes(2, "little")
    moved = data[:place] + bytes(head) + name + data[place + 47 :]
    end = bytearray(moved[moved.rindex(b"PK\x05\x06") :])
    end[12:16] = (46 + len(name)).to_bytes(4, "little")
    path.write_bytes(moved[: moved.rindex(b"PK\x05\x06")] + bytes(end))
    assert "cannot be unpacked" in refusal(path, tmp_path)


def test_an_archive_with_a_password_is_reported(tmp_path):
    path = zipped(tmp_path / "secret.zip", {"a": "x"})
    data = bytearray(path.read_bytes())
    for signature, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        data[data.index(signature) + offset] |= 1
    path.write_bytes(bytes(data))
    assert "password" in refusal(path, tmp_path)


@pytest.mark.parametrize(
    ("assignment", "files", "found"),
    [
        (SCENARIO, {"a.scenario.yaml": "", "b.yaml": ""}, "a.scenario.yaml"),
        (SCENARIO, {"deep/b.yaml": "", "notes.txt": ""}, "deep/b.yaml"),
        (FUNCTION, {"a.py": "def ik(x):\n", "b.py": "def other(x):\n"}, "a.py"),
        (RECORDING, {"bag/metadata.yaml": "", "bag/bag_0.db3": ""}, "bag"),
        (RECORDING, {"readme.md": "", "out/joints.csv": ""}, "out/joints.csv"),
        (SCENARIO, {"a.scenario.yaml": "", "b.scenario.yaml": ""}, None),
        (SCENARIO, {"a.py": ""}, None),
        (FUNCTION, {"a.py": "def solve(x):\n"}, None),
        (RECORDING, {"a.csv": "", "b.mcap": ""}, None),
    ],
)
def test_the_file_that_is_graded_follows_from_the_assignment(tmp_path, assignment, files, found):
    for name, content in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(content)
    if found is None:
        with pytest.raises(SubmissionError, match=r"it lacks|files that may be"):
            main_file(tmp_path, assignment)
    else:
        assert main_file(tmp_path, assignment) == tmp_path / found
