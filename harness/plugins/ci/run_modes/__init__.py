"""Options of `harness run` for pipelines."""
