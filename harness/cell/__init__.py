"""The robot cell that steps work in: the program, names in scope, adapters, goals."""
