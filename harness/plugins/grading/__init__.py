"""Points for a recorded bag or run that another program produced."""

EXTRAS = {"rosbags": "bags", "mcap": "bags", "zstandard": "bags", "lz4": "bags"}
"""Packages that it needs, and the extra that has each."""
