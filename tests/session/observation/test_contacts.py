"""Every pair that touched, with when, how long and how hard."""

import json
from dataclasses import replace

import pytest

from harness.cli.main import main
from harness.recording.read_run import read_run
from harness.session.observation.contacts import contact_records
from tests.judging.synthetic_run import force, make_run
from tests.session.front_door import run

N = 200


def test_each_pair_has_its_first_time_all_its_time_and_its_peak():
    twice = force(N, (20, 40)) + 3 * force(N, (100, 110))
    touched = {
        ("arm_link", "box"): twice,
        ("Table", "box"): force(N, (0, N)),
        ("palm", "box"): force(N),
    }
    run = replace(make_run(contact_forces=touched), timestep=0.01)
    resting, hit = contact_records(run)
    assert (resting.pair, resting.is_collision) == (("Table", "box"), False)
    assert hit.pair == ("arm_link", "box")
    assert hit.first_time == pytest.approx(0.20)
    assert hit.duration == pytest.approx(0.30)
    assert hit.peak_force == pytest.approx(3 * force(N, (0, 1)).max())
    assert hit.is_collision


def test_an_allowed_contact_is_listed_and_is_no_collision():
    pair = ("arm_link", "box")
    run = make_run(contact_forces={pair: force(N, (5, 9))}, allowed_contacts=(pair,))
    assert [(each.pair, each.is_collision) for each in contact_records(run)] == [(pair, False)]


def test_a_recording_without_contacts_lists_none():
    run = replace(make_run(contact_forces={}), unrecorded=("contact_forces",))
    assert contact_records(run) == ()


def test_contacts_are_in_the_run_and_reported_when_it_is_judged(tmp_path, capsys):
    steps = "- wait: 0.3 s"
    stool = """
        objects:
          - {name: stool, box: {size: [0.1, 0.1, 0.1]}, mass: 200 g, pose: {xyz: [0.5, 0.4, 0.05]}}
        expect: [never: collision]
        """
    _, saved = run(tmp_path, steps, rest=stool)
    folder = tmp_path / "report"
    [contact] = json.loads((folder / "run.json").read_text())["contacts"]
    assert contact["pair"] == ["ground_plane", "stool"]
    assert contact["duration"] == pytest.approx(0.3, abs=0.01)
    assert contact["peak_force"] > 0.2 * 9.8 / 4
    assert contact["is_collision"] is False
    assert read_run(folder).run.contacts == saved.contacts != ()
    assert main(["judge", str(folder), "--contacts"]) == 0
    assert "ground_plane and stool" in capsys.readouterr().out
    assert main(["judge", str(folder)]) == 0
    assert "stool" not in capsys.readouterr().out
