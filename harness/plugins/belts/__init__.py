"""Belts and turntables: a step that drives them, picking and placing in motion."""
