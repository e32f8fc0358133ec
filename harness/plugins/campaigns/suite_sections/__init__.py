"""Sections of a suite's page."""
