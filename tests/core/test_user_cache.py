"""Files in the user's cache directory: damaged ones, and the size that all of them keep within."""

import os

import pytest

from harness.core import user_cache
from harness.core.files import expanded, home_folder
from harness.core.user_cache import cache_folder, cached, store
from tests.commands import forked


@pytest.fixture(autouse=True)
def empty_cache(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


def stored_before(name, content, seconds):
    """A file that was used last some time ago."""
    store(name, content)
    file = cache_folder() / name
    used = file.stat().st_mtime - seconds
    os.utime(file, (used, used))


def test_what_was_not_read_for_longest_is_removed(monkeypatch):
    for seconds, name in enumerate(("trees/c", "trees/b", "meshes/a")):
        stored_before(name, bytes(1000), 60 + seconds)
    assert cached("meshes/a") == bytes(1000)  # is now the one read last
    monkeypatch.setattr(user_cache, "LARGEST", 3500)
    store("d", bytes(1000))
    assert cached("trees/b") is None
    assert all(cached(name) == bytes(1000) for name in ("meshes/a", "trees/c", "d"))


def test_nothing_is_removed_within_the_limit(monkeypatch):
    monkeypatch.setattr(user_cache, "LARGEST", 10_000)
    for number in range(5):
        stored_before(f"meshes/{number}", bytes(1000), 1000 * number)
    assert all(cached(f"meshes/{number}") == bytes(1000) for number in range(5))


def test_what_a_crashed_process_left_is_removed_too(monkeypatch):
    stored_before("meshes/tmp_of_a_crash", bytes(5000), 100)
    monkeypatch.setattr(user_cache, "LARGEST", 5000)
    store("meshes/new", bytes(1000))
    assert [file.name for file in (cache_folder() / "meshes").iterdir()] == ["new"]


def test_a_damaged_file_is_as_good_as_none():
    store("a", b"content")
    file = cache_folder() / "a"
    file.write_bytes(file.read_bytes()[:-1])
    assert cached("a") is None


def stored_by_a_number(out, _notify):
    """Use the cache as a user that is a number, without a home folder, as in some containers."""
    for name in ("HOME", "XDG_CACHE_HOME"):
        os.environ.pop(name, None)
    with out.open("w") as stream:
        os.setuid(12345)
        store("trees/a", b"content")
        stream.write(repr((home_folder(), cached("trees/a"), expanded("~/a"))))


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can become another user")
def test_without_a_home_folder_nothing_is_kept_and_nothing_fails(tmp_path):
    forked(stored_by_a_number, tmp_path / "out")
    assert (tmp_path / "out").read_text() == "(None, None, PosixPath('~/a'))"
