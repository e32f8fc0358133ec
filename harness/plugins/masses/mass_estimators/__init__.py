"""What estimates the masses of links."""
