"""Grips by suction."""
