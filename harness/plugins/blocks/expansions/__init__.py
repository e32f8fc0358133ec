"""What the step `include` is replaced by."""
