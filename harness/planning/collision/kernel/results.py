"""Results of `certify` that are no states."""

FULL = -(2**62)
"""The memory for intervals is full."""
