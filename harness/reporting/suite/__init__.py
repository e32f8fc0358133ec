"""The results of many runs: JSON for machines, JUnit XML, GitHub annotations, a page for people."""
