"""The built-in expectations, one module for each word."""
