"""Reads a file as a checked scenario: parameters, short forms, overrides, mistakes."""
