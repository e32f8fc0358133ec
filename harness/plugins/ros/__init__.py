"""ROS 2: nodes move the arm of a scenario, and scenarios move the arm of other programs."""

EXTRAS = {"rclpy": "ros"}
"""Packages that it needs for bags and nodes of ROS 2's own libraries."""
