"""Each reader's campaign in small: the files are good, and changed ones end in located errors."""

import os
import signal
import time

import pytest

from tests.campaigns import fuzz
from tests.campaigns.execution import FEW
from tests.campaigns.fuzz import campaign
from tests.campaigns.reader import Reader
from tests.campaigns.readers import READERS

FAST = ("csv", "conditions", "rtps", "bridge", "scene", "submission")


@pytest.mark.nightly(but=list(FAST))
@pytest.mark.parametrize("name", READERS)
def test_a_reader_refuses_changed_files_at_their_place(name, tmp_path):
    outcome = campaign(name, tmp_path, seed=0, seconds=0.0)
    assert outcome.executions >= FEW
    assert not outcome.findings, outcome.findings


def spin(_folder, data):
    while data == b"bad":
        pass


def sleep(_folder, data):
    if data == b"bad":
        time.sleep(3600)


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("read", "cap", "limit"), [(spin, "LONGEST", 0.3), (sleep, "LONGEST_WAIT", 2.0)]
)
def test_a_reader_that_computes_or_waits_without_end_is_a_finding(
    read, cap, limit, tmp_path, monkeypatch
):
    monkeypatch.setattr(fuzz, cap, limit)
    reader = Reader(lambda _: [b"good"], lambda _corpus, _rng: b"bad", lambda _: read)
    monkeypatch.setitem(READERS, "endless", reader)
    found = campaign("endless", tmp_path, seed=0, seconds=0.0)
    assert [key.startswith("it hangs") for key in found.findings] == [True]
    assert found.executions == 1


def corpus_in_a_new_folder(folder):
    (folder / "files").mkdir()
    return [b"good"]


def test_a_reader_has_a_second_campaign_in_the_same_folder(tmp_path, monkeypatch):
    monkeypatch.setitem(
        READERS,
        "again",
        Reader(corpus_in_a_new_folder, lambda _corpus, _rng: b"other", lambda _: lambda *_: None),
    )
    for _ in range(2):
        assert campaign("again", tmp_path, seed=0, seconds=0.0).executions == FEW


def test_a_campaign_goes_on_after_a_native_crash(tmp_path, monkeypatch):
    crashed = tmp_path / "crashed"

    def read(_folder, data):
        if data == b"bad" and not crashed.exists():
            crashed.touch()
            os.kill(os.getpid(), signal.SIGKILL)

    reader = Reader(corpus_in_a_new_folder, lambda _corpus, _rng: b"bad", lambda _: read)
    monkeypatch.setitem(READERS, "crash", reader)
    found = campaign("crash", tmp_path / "campaign", seed=0, seconds=3.0)
    assert [key.partition(":")[0] for key in found.findings] == ["native crash"]
    assert found.executions > 1
