"""Collision checks of states and edges, with clearance certificates."""
