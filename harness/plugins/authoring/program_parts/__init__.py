"""Remarks on the robot of a scenario."""
