"""Files of other programs as ours: SDF worlds, MoveIt scenes."""
