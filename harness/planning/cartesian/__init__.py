"""Motions along lines and arcs, and sequences of them with blends."""
