"""Steps made of steps: `include`, `repeat`."""
