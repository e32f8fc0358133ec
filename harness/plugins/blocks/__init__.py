"""Steps made of steps, here and in other files."""
