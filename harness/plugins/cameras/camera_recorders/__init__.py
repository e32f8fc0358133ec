"""Recorders of what cameras saw."""
