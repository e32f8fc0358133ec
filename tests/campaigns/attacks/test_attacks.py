"""A few tries of each attack on commands; the campaign has many."""

import subprocess
import sys

import pytest

from docs import ROOT
from tests.campaigns.attacks.__main__ import ATTACKS


@pytest.fixture(scope="module")
def workshop(tmp_path_factory):
    return tmp_path_factory.mktemp("workshop") / "made"


@pytest.mark.nightly
@pytest.mark.parametrize("name", ATTACKS)
def test_commands_withstand_an_attack(name, workshop):
    words = f"-m tests.campaigns.attacks {name} --count 3 --dry --workshop {workshop}"
    done = subprocess.run(
        [sys.executable, *words.split()], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "3 tries" in done.stdout
