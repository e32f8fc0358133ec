"""Ways in which several arms work at once."""
