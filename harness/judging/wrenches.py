"""Readings of sensors of force and torque, averaged as limits are compared with them."""

from __future__ import annotations

import numpy as np

from harness.core.types import FloatArray
from harness.judging.hold import recent_mean
from harness.judging.temporal import TIME_RESOLUTION
from harness.judging.window import NotObservable
from harness.recording.run import Run


def averaged_wrench(run: Run, sensor: str, span: float) -> FloatArray:
    """Mean of a sensor's readings over the last `span` seconds, one reading at least, shape (N, 6).

    Force [N], then torque [N m], in the sensor's axes; NaN where a reading of that time is unknown.

    Raises:
        NotObservable: The sensor was not recorded.
    """
    if sensor not in run.signals.wrenches:
        raise NotObservable(f"the sensor '{sensor}' was not recorded")
    readings = run.signals.wrenches[sensor]
    unknown = np.isnan(readings).any(axis=1, keepdims=True).astype(float)
    rows = np.hstack([np.nan_to_num(readings), unknown])
    mean = recent_mean(run, rows, max(span - 2 * TIME_RESOLUTION, 0.0))
    return np.where(mean[:, 6:] * len(rows) > 0.5, np.nan, mean[:, :6])
