"""Formulas of signal temporal logic as expectations."""
