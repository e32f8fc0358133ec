"""The commands `describe` and `skill`."""
