"""The solvers, one module for each."""
