"""The studio: a robot cell in a browser, whose actions grow into a scenario."""

EXTRAS = {"websockets": "studio", "django_static_ace_builds": "studio"}
"""Packages that it needs, and the extra that has each."""
