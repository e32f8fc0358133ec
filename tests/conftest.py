"""Fixtures and plugins for every test."""

pytest_plugins = ["pytester", "tests.reporting.browser"]
