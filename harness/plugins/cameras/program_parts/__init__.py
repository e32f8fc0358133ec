"""What a scenario says of pictures."""
