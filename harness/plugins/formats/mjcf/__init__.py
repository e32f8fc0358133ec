"""Imports MJCF scenes as worlds."""
