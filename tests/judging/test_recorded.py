"""What was not recorded is not observable, whichever way it is read."""

import math
import operator
from dataclasses import replace

import pytest

from harness.judging.expectations.gripper import GripperState
from harness.judging.recorded import guard_unrecorded
from harness.judging.window import NotObservable
from harness.plugins.paths.expectations.fraction import FractionCheck
from tests.judging.synthetic_run import lift_run, make_run, verdict

READINGS = {
    "loop": list,
    "length": len,
    "truth": bool,
    "membership": lambda records: None in records,
    "first": lambda records: records[0],
    "slice": lambda records: records[-1:],
    "backwards": lambda records: list(reversed(records)),
    "comparison": lambda records: records == (),
    "difference": lambda records: records != (),
    "hash": hash,
    "sum": lambda records: (*(), *records),
    "before": lambda records: operator.add(records, ()),
    "after": lambda records: operator.add((), records),
    "count": lambda records: records.count(None),
    "index": lambda records: records.index(None),
    "sorting": sorted,
}


@pytest.mark.parametrize("reading", READINGS.values(), ids=READINGS)
def test_attachments_that_were_not_recorded_cannot_be_read_as_none(reading):
    run = guard_unrecorded(replace(lift_run(), unrecorded=("attachments",)))
    with pytest.raises(NotObservable, match="what the planning scene attached was not recorded"):
        reading(run.attachments)


def test_attachments_that_were_recorded_are_read_as_they_are():
    run = replace(lift_run(), unrecorded=("contact_forces",))
    assert guard_unrecorded(run).attachments == run.attachments


@pytest.mark.parametrize("name", ["contact_forces", "clearances", "joint_velocities"])
def test_a_signal_that_was_not_recorded_cannot_be_read(name):
    with pytest.raises(NotObservable, match="were not recorded"):
        getattr(guard_unrecorded(replace(lift_run(), unrecorded=(name,))).signals, name)


@pytest.mark.parametrize("expectation", [FractionCheck(), GripperState(stalled=True)])
def test_what_steps_report_is_not_observable_where_no_steps_were_recorded(expectation):
    assert verdict(make_run(), expectation).status == "not reached"
    judged = verdict(replace(make_run(), unrecorded=("steps",)), expectation)
    assert judged.status == "not observable"
    assert "what the steps reported was not recorded" in judged.reason
    assert math.isnan(judged.margin)
