"""pytest collects scenario files."""
