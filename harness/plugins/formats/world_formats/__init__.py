"""The world formats of other programs."""
