"""Suction cups: where they hold an object, and with which force."""
