"""What a scenario, world or robot file says."""
