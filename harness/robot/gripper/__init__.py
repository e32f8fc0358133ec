"""Grippers and TCPs inferred from a description without annotations."""
