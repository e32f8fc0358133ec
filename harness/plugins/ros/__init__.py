"""ROS 2: nodes move the arm of a scenario, and scenarios move the arm of other programs."""

EXTRAS = {"rosbags": "bags", "scipy": "bags"}
"""Packages that it needs, and the extra that has each."""
