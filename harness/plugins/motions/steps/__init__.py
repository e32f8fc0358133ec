"""The steps `sequence` and `cartesian_path`."""
