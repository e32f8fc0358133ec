"""Expectations of the motion and the effort of arms, and of their distances."""
