"""The results of many runs: JSON for machines, a page for people."""
