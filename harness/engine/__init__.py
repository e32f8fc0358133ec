"""Compiles a scenario to a program, and executes the program."""
