"""Verdicts from a recorded run."""
