"""Robots read from MJCF."""
