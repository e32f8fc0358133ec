"""A run does not depend on what other code did in the same process before."""

import json
import subprocess
import sys

import mujoco
import pytest

from harness.core.resources import data_folder
from tests.running import run_case

SCENARIO = data_folder("scenarios") / "picking/01_stack_two_boxes.scenario.yaml"

OTHER_CODE = {
    "nothing": "",
    "Coal": """
import coal, numpy as np
box, here = coal.Box(1.0, 1.0, 1.0), coal.Transform3s(np.eye(3), np.zeros(3))
there = coal.Transform3s(np.eye(3), np.array([0.0, 0.0, 5.0]))
coal.distance(box, here, box, there, coal.DistanceRequest(), coal.DistanceResult())
""",
    "random numbers": """
import random, numpy, pinocchio
from ompl.util import RNG
random.seed(3), numpy.random.seed(3), pinocchio.seed(3), RNG.setSeed(17), RNG().uniform01()
""",
    "NumPy and YAML": """
import numpy, yaml
numpy.set_printoptions(precision=2, suppress=True, threshold=3), numpy.seterr(all="raise")
yaml.SafeLoader.add_constructor("tag:yaml.org,2002:float", lambda loader, node: 1.0)
""",
}

RUN = """
import json, sys
from pathlib import Path
from harness.session.run_case import run_case
from harness.session.run_request import RunRequest
result = run_case(RunRequest(Path(sys.argv[1]), stills=False))
print(json.dumps([result.outcome, result.digest]))
"""


@pytest.fixture(scope="module")
def first():
    return run_case(SCENARIO, stills=False)


@pytest.mark.nightly
@pytest.mark.parametrize("before", OTHER_CODE.values(), ids=OTHER_CODE)
def test_a_run_has_the_same_digest_after_other_code(first, before):
    command = [sys.executable, "-c", before + RUN, str(SCENARIO)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert json.loads(done.stdout.splitlines()[-1]) == ["passed", first.digest]


def _pushes(_, data):
    data.qfrc_applied[:] = 1.0


@pytest.mark.parametrize("name", ["control", "passive", "contactfilter"])
def test_physics_that_other_code_would_change_is_refused(name):
    getattr(mujoco, f"set_mjcb_{name}")(_pushes)
    try:
        result = run_case(SCENARIO, stills=False)
    finally:
        getattr(mujoco, f"set_mjcb_{name}")(None)
    assert result.outcome == "invalid"
    assert f"call mujoco.set_mjcb_{name}(None)" in result.message
