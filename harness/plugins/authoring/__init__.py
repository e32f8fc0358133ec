"""Examines robots, and begins scenarios and projects."""
