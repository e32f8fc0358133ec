"""Time parametrisation of paths within limits."""
