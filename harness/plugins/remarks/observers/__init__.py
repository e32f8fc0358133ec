"""Findings that follow from the record of a run alone."""
