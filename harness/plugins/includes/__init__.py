"""Steps from other files."""
