"""Xacro files, rendered in a process of their own."""
