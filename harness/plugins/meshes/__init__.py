"""Convex parts of meshes, with which planner and physics collide."""
