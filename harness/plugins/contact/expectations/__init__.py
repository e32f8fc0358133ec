"""What is expected of work in contact."""
