"""The built-in planning pipelines, one module for each."""
