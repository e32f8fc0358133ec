"""What pipelines show of results, and margins that may not shrink unnoticed."""
