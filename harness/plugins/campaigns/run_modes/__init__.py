"""The run mode of campaigns."""
