"""The option `--film` of `harness run`."""
