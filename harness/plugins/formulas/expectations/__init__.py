"""The expectation of formulas."""
