"""The commands `compare` and `judge`."""
