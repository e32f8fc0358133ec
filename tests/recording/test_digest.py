"""What the digest sees, and what it must not see."""

from dataclasses import replace

import numpy as np
import pytest

from harness.assertions.judge import judge
from harness.recording.digest import digest
from tests.assertions.synthetic_run import lift_run
from tests.recording.test_store import EXPECTED, full_run

RUN = full_run()
VERDICTS = judge(RUN, EXPECTED)
BASE = digest(RUN, VERDICTS)


def with_signal(**signals):
    return replace(RUN, signals=replace(RUN.signals, **signals))


def test_it_is_sha256_in_hex_and_the_same_every_time():
    assert len(BASE) == 64
    assert digest(full_run(), judge(full_run(), EXPECTED)) == BASE


def test_words_lines_paths_versions_and_seeds_do_not_enter():
    other = replace(
        RUN,
        scenario="another title",
        file="elsewhere.yaml",
        source="",
        resolved="",
        versions={},
        steps=tuple(replace(step, line=99, summary="x", id="renamed") for step in RUN.steps),
    )
    verdicts = [
        replace(verdict, expectation="other", line=1, reason="other", step="x")
        for verdict in VERDICTS
    ]
    assert digest(other, verdicts) == BASE


def test_the_order_in_which_signals_were_stored_does_not_enter():
    forces = RUN.signals.contact_forces
    assert len(forces) > 1
    assert digest(with_signal(contact_forces=dict(reversed(forces.items()))), VERDICTS) == BASE


def test_one_bit_of_one_sample_enters():
    positions = RUN.signals.joint_positions.copy()
    positions[150, 1] = np.nextafter(0.0, 1.0)
    assert digest(with_signal(joint_positions=positions), VERDICTS) != BASE
    positions[150, 1] = -0.0
    assert digest(with_signal(joint_positions=positions), VERDICTS) != BASE


def test_every_nan_is_alike_and_strides_do_not_matter():
    (key,) = RUN.signals.clearances
    digests = set()
    for bits in (0x7FF8000000000000, 0xFFF8000000000123):
        distances = RUN.signals.clearances[key].copy()
        distances[0] = np.frombuffer(np.uint64(bits).tobytes())[0]
        assert np.isnan(distances[0])
        digests.add(digest(with_signal(clearances={key: distances}), VERDICTS))
    assert len(digests) == 1
    assert digests != {BASE}
    fortran = np.asfortranarray(RUN.signals.tcp_pose)
    assert digest(with_signal(tcp_pose=fortran), VERDICTS) == BASE


def test_names_and_shapes_of_signals_enter():
    forces = {(a, f"{b}_2"): force for (a, b), force in RUN.signals.contact_forces.items()}
    assert digest(with_signal(contact_forces=forces), VERDICTS) != BASE
    flat = RUN.signals.tcp_pose.reshape(-1)
    assert digest(with_signal(tcp_pose=flat), VERDICTS) != BASE


@pytest.mark.parametrize(
    "change", [{"status": "failed"}, {"margin": 0.0}, {"unit": "rad"}, {"time": 0.0}]
)
def test_what_a_verdict_says_enters(change):
    assert digest(RUN, [replace(VERDICTS[0], **change), *VERDICTS[1:]]) != BASE
    assert digest(RUN, VERDICTS[:-1]) != BASE


def test_commanded_trajectories_enter():
    first, *others = RUN.steps
    moved = replace(first.trajectory, positions=first.trajectory.positions + 1e-12)
    other = replace(first, trajectory=moved)
    assert digest(replace(RUN, steps=(other, *others)), VERDICTS) != BASE
    renamed = replace(first, trajectory=replace(first.trajectory, joint_names=("elbow",)))
    assert digest(replace(RUN, steps=(renamed, *others)), VERDICTS) != BASE
    assert digest(lift_run(), ()) != digest(lift_run(height=0.09), ())
