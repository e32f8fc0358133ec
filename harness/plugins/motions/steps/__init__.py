"""The steps `sequence`, `cartesian_path` and `circ`."""
