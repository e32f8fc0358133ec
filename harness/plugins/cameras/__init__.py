"""Cameras: a step that keeps a picture, and what pictures must show."""
