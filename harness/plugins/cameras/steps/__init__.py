"""Steps with cameras."""
