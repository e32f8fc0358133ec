"""The step `include`."""
