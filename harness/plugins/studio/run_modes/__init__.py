"""The run mode of the studio."""
