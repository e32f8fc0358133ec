"""URDF read and written."""
