"""Keys of steps about how an arm moves."""
