"""The case runner of ROS 2."""
