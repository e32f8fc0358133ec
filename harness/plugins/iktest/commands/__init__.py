"""The command of inverse kinematics tests."""
