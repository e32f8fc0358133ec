"""Steps with belts."""
