"""Values of `--format` that services read, one module for each."""
