"""Robots read from SDFormat."""
