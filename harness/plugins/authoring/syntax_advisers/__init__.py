"""What files that are not YAML lack."""
