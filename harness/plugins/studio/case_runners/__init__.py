"""The case runner of the studio."""
