"""Results that cases share: taken for equal inputs, computed for others, and never too many."""

import pytest

from harness.core import sharing
from harness.core.sharing import SharedResults, shared


@pytest.fixture
def folder():
    sharing.open_folder()
    yield
    sharing.close_folder()


def no_computation():
    raise AssertionError("it was computed before")


@pytest.mark.usefixtures("folder")
def test_a_result_is_computed_once_for_the_same_inputs():
    tally = sharing.begin()
    assert shared("sums", lambda: (1, 2), lambda: [3]) == [3]
    assert shared("sums", lambda: (1, 2), no_computation) == [3]
    assert shared("sums", lambda: (1, 2.0), lambda: [3.0]) == [3.0]
    assert shared("others", lambda: (1, 2), lambda: [4]) == [4]
    assert tally.counts() == {"others": (0, 1), "sums": (1, 3)}


@pytest.mark.usefixtures("folder")
def test_inputs_without_exact_bytes_are_computed_every_time():
    assert [shared("sums", lambda: (object(),), lambda n=n: n) for n in (1, 2)] == [1, 2]


@pytest.mark.usefixtures("folder")
def test_nothing_is_shared_without_a_folder_or_against_the_request():
    shared("sums", lambda: (1,), lambda: 1)
    sharing.begin(share=False)
    assert shared("sums", lambda: (1,), lambda: 2) == 2
    assert sharing.chain("sums") is None


@pytest.mark.usefixtures("folder")
def test_a_chain_is_kept_from_the_second_case_on():
    def case(values):
        chain = sharing.chain("parts")
        taken = []
        for value in values:
            found = chain.find(str(value))
            taken.append(found is not None)
            if found is None:
                chain.keep(str(value), lambda value=value: value, 1, "")
        return taken

    assert case([1, 2, 3]) == [False, False, False]
    assert case([1, 2, 4]) == [False, False, False]
    assert case([1, 2, 5, 6]) == [True, True, False, False]
    assert case([1, 2, 5, 6]) == [True, True, False, False]
    assert case([1, 2, 5, 6]) == [True, True, True, True]


def test_the_least_recently_used_results_make_room(tmp_path, monkeypatch):
    monkeypatch.setattr(sharing, "LOOK_EVERY", 1)
    results = SharedResults(tmp_path, most_bytes=5000)
    for number in range(20):
        results.keep(f"key{number}", b"0" * 1000)
        assert results.find("key0") is not None
    size = sum(file.stat().st_size for file in tmp_path.iterdir())
    assert size <= 5000
    assert results.find("key19") is not None
    assert results.find("key5") is None


@pytest.mark.usefixtures("folder")
def test_a_damaged_result_is_computed_again():
    shared("sums", lambda: (1,), lambda: "long enough to be cut off")
    [file] = sharing.open_folder().iterdir()
    file.write_bytes(file.read_bytes()[:-9])
    assert shared("sums", lambda: (1,), lambda: 2) == 2


def test_the_folder_is_private_and_goes_away():
    folder = sharing.open_folder()
    assert folder.stat().st_mode & 0o077 == 0
    sharing.close_folder()
    assert not folder.exists()
