"""Each reader's campaign in small: the files are good, and changed ones end in located errors."""

import pytest

from tests.campaigns.execution import FEW
from tests.campaigns.fuzz import campaign
from tests.campaigns.readers import READERS

FAST = ("csv", "conditions", "rtps", "bridge", "scene", "submission")


@pytest.mark.nightly(but=list(FAST))
@pytest.mark.parametrize("name", READERS)
def test_a_reader_refuses_changed_files_at_their_place(name, tmp_path):
    outcome = campaign(name, tmp_path, seed=0, seconds=0.0)
    assert outcome.executions >= FEW
    assert not outcome.findings, outcome.findings
