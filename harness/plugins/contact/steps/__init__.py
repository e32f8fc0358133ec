"""Steps in contact."""
