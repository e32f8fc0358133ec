"""A class of submissions, graded by one assignment."""
