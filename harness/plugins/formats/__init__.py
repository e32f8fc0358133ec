"""Worlds and requests in the formats of other programs: SDF, MJCF, MoveIt."""
