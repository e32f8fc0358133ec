"""The built-in inverse kinematics solvers, one module for each."""
