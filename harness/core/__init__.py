"""Nouns without dependencies: poses, shapes, trajectories, errors."""
