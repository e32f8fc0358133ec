"""Worlds and models read from SDFormat."""
