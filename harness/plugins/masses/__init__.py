"""Masses of links whose file gives none."""
