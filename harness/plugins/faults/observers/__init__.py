"""What faults did in a run."""
