"""Findings about pictures."""
