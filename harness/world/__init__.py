"""Objects of the world, and worlds read from other formats."""
