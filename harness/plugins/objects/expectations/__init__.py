"""Expectations of where objects are, what they touch, and whether they stay."""
