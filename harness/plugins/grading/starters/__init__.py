"""Folders with which grading systems run `harness grade-class`."""
