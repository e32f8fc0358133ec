"""Keys of a file about ROS 2."""
