"""Robots of files without a robot.yaml, whose content follows from the files."""
