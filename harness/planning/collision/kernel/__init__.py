"""The compiled check of motions, in the subset of Python that numba compiles."""
