"""Reporters for ROS 2."""
