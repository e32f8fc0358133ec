"""Importer of third-party recordings, rosbag2 or MCAP, as runs that can be judged."""
