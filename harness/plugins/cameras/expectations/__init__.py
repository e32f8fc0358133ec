"""Expectations of pictures."""
