"""What the digest sees, and what it must not see."""

import hashlib
import struct
from dataclasses import replace

import numpy as np
import pytest

from harness.core.trajectory import JointTrajectory
from harness.judging.judge import judge
from harness.recording.arrays import arrays_of
from harness.recording.digest import digest
from harness.recording.verdict import Verdict
from tests.judging.synthetic_run import lift_run, make_run, step
from tests.recording.test_run_folder import EXPECTED, full_run

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


def test_the_bytes_of_a_small_run_are_those_of_the_definition():
    """Each chunk after its length: names, dtype with shape, and little-endian numbers."""
    rows = np.array([[1.0, 2.0], [3.0, 4.0]])
    trajectory = JointTrajectory(("one", "two"), np.array([0.0, 1.5]), rows, 2 * rows, 3 * rows)
    verdict = Verdict("e", "passed", 0.25, "m", 1.0)
    run = make_run(
        0, objects=(), steps=(step("go", 0, 1, trajectory=trajectory), step("wait", 0, 1))
    )
    hasher = hashlib.sha256(b"armharness-digest/1")

    def put(*chunks):
        for chunk in chunks:
            hasher.update(len(chunk).to_bytes(8, "little") + chunk)

    def put_floats(*values, shape):
        put(f"<f8{shape}".encode(), struct.pack(f"<{len(values)}d", *values))

    put(b"trajectory", b"accelerations")
    put_floats(3, 6, 9, 12, shape="(2, 2)")
    put(b"joint_names", b"one", b"two", b"positions")
    put_floats(1, 2, 3, 4, shape="(2, 2)")
    put(b"times")
    put_floats(0.0, 1.5, shape="(2,)")
    put(b"velocities")
    put_floats(2, 4, 6, 8, shape="(2, 2)")
    for name, array in sorted(arrays_of(run.signals).items()):
        assert array.size == 0, name
        put(
            name.encode(),
            f"{'<f8' if array.dtype.kind == 'f' else '<i8'}{array.shape}".encode(),
            b"",
        )
    put_floats(run.signals.clearance_cutoff, shape="(1,)")
    put(b"verdict", b"passed", b"m")
    put_floats(0.25, 1.0, shape="(2,)")
    assert digest(run, [verdict]) == hasher.hexdigest()
