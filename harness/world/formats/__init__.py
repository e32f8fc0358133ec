"""The built-in world formats, one module for each."""
