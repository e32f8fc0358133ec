"""What is resolved of a scenario for the ROS 2 graph."""
