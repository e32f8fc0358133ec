"""Steps with ROS 2 nodes."""
