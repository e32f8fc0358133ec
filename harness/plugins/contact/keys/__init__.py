"""Keys of a file about work in contact."""
