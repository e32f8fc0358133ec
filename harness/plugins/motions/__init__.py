"""Blended sequences, Cartesian paths, and motions of a link with times of its own."""
