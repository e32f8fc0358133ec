"""Keys of a file about searches of failures."""
