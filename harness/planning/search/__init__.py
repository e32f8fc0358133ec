"""Sampling-based search with OMPL and roadmaps, and shortening."""
