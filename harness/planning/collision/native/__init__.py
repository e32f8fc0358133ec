"""The check of motions in C: its sources, how they are compiled and how they are called."""
