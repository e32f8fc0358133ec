"""TOPP-RA, imported without the pictures, splines and sparse solvers that are not used here."""

from __future__ import annotations

import logging
import warnings

from harness.core.deferred_import import deferred

with (
    warnings.catch_warnings(),
    deferred("matplotlib", "matplotlib.pyplot", "scipy", "scipy.sparse", "scipy.interpolate"),
):
    warnings.simplefilter("ignore")  # invalid escapes of its own
    import toppra as toppra
logging.getLogger("toppra").setLevel(logging.CRITICAL)
