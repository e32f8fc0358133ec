"""Worlds read from MoveIt's .scene text."""
