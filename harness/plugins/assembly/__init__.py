"""Puts arms on pedestals and rails, and joins several arms into one robot."""
