"""YAML and XML files whose values know their line and column."""
