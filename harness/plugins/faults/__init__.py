"""Faults that a scenario injects."""
