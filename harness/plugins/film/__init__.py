"""Films of runs, for slides, issues and phones."""
