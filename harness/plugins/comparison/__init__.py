"""Compares two saved runs."""
