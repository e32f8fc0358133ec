"""Keys of a file about how robots are set up."""
