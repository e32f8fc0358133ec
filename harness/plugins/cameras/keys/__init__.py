"""Keys of a file about what cameras see."""
