"""Expectations of smooth and direct motions."""
