"""Files of suites for pipelines, one module for each."""
