"""Formats of robots' files."""
