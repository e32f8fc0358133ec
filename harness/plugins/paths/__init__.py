"""Paths of the TCP: seams that are followed within a tolerance."""
