"""Kinds of convex sets."""

POINTS, POLYTOPE, CYLINDER, HALF_SPACE = range(4)
"""A few points, the corners of a hull with its edges, and solids with a formula."""
