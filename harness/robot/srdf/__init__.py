"""SRDF read, checked and proposed."""
