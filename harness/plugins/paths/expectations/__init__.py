"""Expectations of paths."""
