"""The command of grading."""
