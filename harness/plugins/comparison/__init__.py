"""Compares two saved runs, and judges one again."""
