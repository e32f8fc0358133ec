"""What users should know of a run besides its verdicts."""
