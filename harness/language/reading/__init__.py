"""Reads a file as a checked scenario: includes, parameters, short forms, overrides, mistakes."""
