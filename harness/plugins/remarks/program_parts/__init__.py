"""Remarks on a scenario before it is carried out."""
