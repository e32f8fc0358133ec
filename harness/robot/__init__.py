"""The robot as one description, from URDF, SRDF and robot.yaml."""
