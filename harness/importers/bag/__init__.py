"""Recordings of other programs, rosbag2 or MCAP, as a run that can be judged."""
