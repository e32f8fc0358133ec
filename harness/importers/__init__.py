"""Importers of other programs' files: SDF worlds, MoveIt scenes, recordings."""
