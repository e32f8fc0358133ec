"""Joint goals for pose goals: branches, ranking, choice."""
