"""Mistakes of unlike regions are findings of their own; one mistake is one finding."""

from math import asin, hypot, pi, sin

import numpy as np
import pytest

from harness.plugins.iktest import IkTest, run_ik_test
from tests.plugins.iktest.arms import OM, correct


def arctangent(x, y, z, pitch):
    """Half a turn of joint 1 off where the target is on the far side of the first axis."""
    return [[a + pi if x < 0.012 else a, *rest] for a, *rest in correct(x, y, z, pitch)]


def arctangent_and_low(x, y, z, pitch):
    """Another 17 mm off where the target is low."""
    return arctangent(x, y, z + 0.017 if z < 0.08 else z, pitch)


def arctangent_and_high(x, y, z, pitch):
    """Another scale of heights where the target is high."""
    return arctangent(x, y, 1.05 * z if z > 0.25 else z, pitch)


def arctangent_and_elbow(x, y, z, pitch):
    """An offset of joint 3 in one of the two postures."""
    return [[a, b, c + 0.05 if c > 0.3 else c, d] for a, b, c, d in arctangent(x, y, z, pitch)]


def misses(ik, seed=0):
    """Findings of answers that miss their targets."""
    report = run_ik_test(IkTest(ik, OM, seed=seed))
    return [each for each in report.findings if each.kind.startswith(("misses", "is off"))]


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("ik", "words", "shows"),
    [
        (arctangent_and_low, "z is below", lambda _, z, __: z < 0.08),
        (arctangent_and_high, "z is above", lambda _, z, __: z > 0.25),
        (arctangent_and_elbow, "joint3 is above", lambda _, __, answer: answer[2] > 0.3),
    ],
)
def test_each_of_two_mistakes_has_its_smallest_example(ik, words, shows):
    by_region = {each.kind.partition("right: ")[2]: each for each in misses(ik)}
    assert len(by_region) == 2
    example = {
        name: (*each.target.pose.translation[[0, 2]], each.answer)
        for name, each in by_region.items()
    }
    [far] = [name for name in by_region if name.startswith("x is below 0.012")]
    [other] = [name for name in by_region if name.startswith(words)]
    assert example[far][0] < 0.012
    assert not shows(*example[far])
    assert shows(*example[other])
    assert example[other][0] >= 0.012


@pytest.mark.nightly
@pytest.mark.parametrize(
    "ik",
    [
        arctangent,
        lambda x, y, z, pitch: correct(x, y, 1.1 * z if hypot(x, y, z) > 0.2 else z, pitch),
        lambda x, y, z, pitch: correct(x, -y if x < 0 and y < 0 else y, z, pitch),
        lambda *target: [[asin(sin(a)), *rest] for a, *rest in correct(*target)],
        lambda *target: [[a, b, 0.95 * c, d] for a, b, c, d in correct(*target)],
        lambda *target: [np.clip(each, -1.0, 1.0) for each in correct(*target)],
    ],
)
def test_one_mistake_is_one_finding(ik):
    def named(x, y, z, pitch):
        return ik(x, y, z, pitch)

    kinds = [each.kind for each in misses(named)]
    assert kinds in (["misses the position"], ["misses the position", "misses the pitch"])


@pytest.mark.nightly
def test_an_error_of_many_targets_is_not_said_to_be_at_every_one():
    def low(x, y, z, pitch):
        return correct(x, y, z + 0.017 if z < 0.12 else z, pitch)

    [finding] = misses(low)
    assert finding.kind == "is off by (0.0, 0.0, 17.0) mm in the world's axes, at many targets"
