"""Tools for a robot's owner: checks, an SRDF proposal, a first scenario, built-in solvers."""
