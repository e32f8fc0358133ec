"""The built-in reporters, one module for each."""
