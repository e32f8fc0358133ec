"""Xacro files, rendered by an interpreter of their expressions."""
