"""The run mode of ROS 2."""
