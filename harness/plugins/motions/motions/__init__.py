"""The kinds of motions, one module for each."""
