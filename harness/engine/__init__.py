"""From a scenario to a program, and from a program to a run."""
