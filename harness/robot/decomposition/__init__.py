"""Convex decomposition of meshes."""
