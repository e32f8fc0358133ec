"""The built-in commands, one module for each."""
