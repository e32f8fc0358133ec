"""Controllers as those of ros2_control, as functions of simulated time and received commands."""
