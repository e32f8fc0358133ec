"""Verdicts from a recorded run alone."""
