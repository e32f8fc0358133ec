"""Independent checks of a planned trajectory."""
